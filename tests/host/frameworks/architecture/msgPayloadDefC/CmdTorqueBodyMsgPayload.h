#pragma once
typedef struct {
  double torqueRequestBody[3];
} CmdTorqueBodyMsgPayload;
