/* What the S-function of docs/recipes.md takes of Simulink, declared as its manual does. */
#pragma once
#include <stddef.h>

typedef int int_T;
typedef double real_T;
typedef const real_T* const* InputRealPtrsType;
typedef struct SimStruct_tag SimStruct;
typedef struct mxArray_tag mxArray;
#define CONTINUOUS_SAMPLE_TIME 0.0

int mxGetString(const mxArray* array, char* text, size_t size);
const mxArray* ssGetSFcnParam(SimStruct* S, int_T index);
void ssSetErrorStatus(SimStruct* S, const char* text);
void ssSetNumSFcnParams(SimStruct* S, int_T count);
int_T ssGetNumSFcnParams(SimStruct* S);
int_T ssGetSFcnParamsCount(SimStruct* S);
void ssSetNumContStates(SimStruct* S, int_T count);
int_T ssGetNumContStates(SimStruct* S);
int_T ssSetNumInputPorts(SimStruct* S, int_T count);
void ssSetInputPortWidth(SimStruct* S, int_T port, int_T width);
int_T ssSetNumOutputPorts(SimStruct* S, int_T count);
void ssSetOutputPortWidth(SimStruct* S, int_T port, int_T width);
void ssSetNumSampleTimes(SimStruct* S, int_T count);
void ssSetSampleTime(SimStruct* S, int_T index, real_T period);
void ssSetNumPWork(SimStruct* S, int_T count);
void** ssGetPWork(SimStruct* S);
real_T* ssGetContStates(SimStruct* S);
real_T* ssGetdX(SimStruct* S);
real_T ssGetT(SimStruct* S);
real_T* ssGetOutputPortRealSignal(SimStruct* S, int_T port);
InputRealPtrsType ssGetInputPortRealSignalPtrs(SimStruct* S, int_T port);
