// The page of reports, made by web/build.mjs, in the library itself: a program needs no other file.
        .section .rodata
        .balign 1
        .global withy_report_page
        .hidden withy_report_page
        .global withy_report_page_end
        .hidden withy_report_page_end
withy_report_page:
#ifdef WITHY_REPORT_PAGE
        .incbin WITHY_REPORT_PAGE
#endif
withy_report_page_end:
        .byte 0
        .section .note.GNU-stack, "", %progbits
