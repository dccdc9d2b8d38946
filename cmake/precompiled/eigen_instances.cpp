#define WITHY_INSTANCE template
#include "eigen_instances.hpp"
