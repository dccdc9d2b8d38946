/* The app's own header, which docs/recipes.md says the contents of. */
#pragma once
#include <cfe.h>

#define PLANT_WAKEUP_MID 0x1890
#define PLANT_EFFORT_MID 0x1891
#define PLANT_PERIOD 0.01
#define PLANT_STOPPED_EID 1
typedef struct {
  CFE_MSG_CommandHeader_t CommandHeader;
  double Effort;
} PLANT_Effort_t;
typedef struct {
  CFE_MSG_TelemetryHeader_t TelemetryHeader;
  double Angle;
} PLANT_Sensors_t;
extern PLANT_Sensors_t PLANT_Sensors;
