/* Stands for the file that S-functions end with, which calls the functions above it. */
#ifndef S_FUNCTION_NAME
#error "an S-function names itself"
#endif
#if S_FUNCTION_LEVEL != 2 || !defined(MDL_START) || !defined(MDL_INITIALIZE_CONDITIONS) || !defined(MDL_DERIVATIVES)
#error "an S-function of level 2 says which functions it has"
#endif
void call_all(SimStruct* S);
void call_all(SimStruct* S) {
  mdlInitializeSizes(S);
  mdlInitializeSampleTimes(S);
  mdlStart(S);
  mdlInitializeConditions(S);
  mdlOutputs(S, 0);
  mdlDerivatives(S);
  mdlTerminate(S);
}
