/* What a Modelica tool gives to external functions, as far as bindings/modelica needs it; the test is the tool. */
#ifndef MODELICA_UTILITIES_H
#define MODELICA_UTILITIES_H
void ModelicaError(const char* message);
#endif
