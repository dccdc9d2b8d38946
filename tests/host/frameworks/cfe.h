/* What the app of docs/recipes.md takes of the core Flight Executive, declared as its interface is documented. */
#pragma once
#include <stdbool.h>
#include <stdint.h>

typedef int32_t int32;
typedef uint16_t uint16;
typedef uint32_t uint32;
typedef int32 CFE_Status_t;
typedef struct {
  uint32 Value;
} CFE_SB_MsgId_t;
typedef struct {
  uint32 Id;
} CFE_SB_PipeId_t;
typedef uint32 CFE_SB_MsgId_Atom_t;
typedef struct {
  uint16 Header[4];
} CFE_MSG_Message_t;
typedef union {
  CFE_MSG_Message_t Msg;
  long double Aligned;
} CFE_SB_Buffer_t;
typedef struct {
  CFE_MSG_Message_t Msg;
} CFE_MSG_CommandHeader_t;
typedef struct {
  CFE_MSG_Message_t Msg;
} CFE_MSG_TelemetryHeader_t;
typedef enum { CFE_EVS_EventType_CRITICAL = 4 } CFE_EVS_EventType_Enum_t;
enum { CFE_ES_RunStatus_APP_RUN = 1, CFE_ES_RunStatus_APP_EXIT, CFE_ES_RunStatus_APP_ERROR };
#define CFE_SUCCESS ((CFE_Status_t)0)
#define CFE_SB_PEND_FOREVER (-1)
#define CFE_SB_INVALID_MSG_ID ((CFE_SB_MsgId_t){0})
#define CFE_MSG_PTR(header) (&(header).Msg)

CFE_Status_t CFE_SB_CreatePipe(CFE_SB_PipeId_t* pipe, uint16 depth, const char* name);
CFE_Status_t CFE_SB_Subscribe(CFE_SB_MsgId_t id, CFE_SB_PipeId_t pipe);
CFE_SB_MsgId_t CFE_SB_ValueToMsgId(CFE_SB_MsgId_Atom_t value);
CFE_SB_MsgId_Atom_t CFE_SB_MsgIdToValue(CFE_SB_MsgId_t id);
CFE_Status_t CFE_SB_ReceiveBuffer(CFE_SB_Buffer_t** buffer, CFE_SB_PipeId_t pipe, int32 timeout);
CFE_Status_t CFE_SB_TransmitMsg(const CFE_MSG_Message_t* message, bool is_origination);
CFE_Status_t CFE_MSG_GetMsgId(const CFE_MSG_Message_t* message, CFE_SB_MsgId_t* id);
CFE_Status_t CFE_EVS_SendEvent(uint16 id, CFE_EVS_EventType_Enum_t type, const char* format, ...);
CFE_Status_t CFE_ES_WriteToSysLog(const char* format, ...);
bool CFE_ES_RunLoop(uint32* status);
void CFE_ES_ExitApp(uint32 status);
