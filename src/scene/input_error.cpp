#include "src/scene/input_error.h"
