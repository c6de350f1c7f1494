/* The application. */
#ifndef APP_H
#define APP_H

#include <stdint.h>

/* Runs until there are no more messages; a code of poinsot_onboard.h. */
int32_t app_main(void);

#endif
