// The scenes that `withy new` writes, in the program itself. Each is a file of scenes/new, which tests run.
        .section .rodata
#define SCENE(kind, file) \
        .global withy_starting_##kind; .hidden withy_starting_##kind; withy_starting_##kind: .incbin file; .byte 0;
SCENE(beam, "beam.yaml")
SCENE(satellite, "satellite.yaml")
SCENE(arm, "arm.yaml")
SCENE(turbine, "turbine.yaml")
        .section .note.GNU-stack, "", %progbits
