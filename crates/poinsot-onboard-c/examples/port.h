/* What a platform gives the application: under cFS the table services, the software bus and the performance log. */
#ifndef PORT_H
#define PORT_H

#include "poinsot_onboard.h"

typedef enum { PORT_SAMPLE, PORT_HOUSEKEEPING } port_kind;

typedef struct {
    port_kind kind;
    poinsot_onboard_sample sample; /* of housekeeping the time alone */
} port_message;

typedef enum { PORT_PERF_PUSH, PORT_PERF_READ, PORT_PERF_COUNT } port_perf;

/* The table of the filter. */
const uint8_t *port_table(size_t *length);

/* The next message; 0 at the end. */
int port_receive(port_message *message);

/* Housekeeping telemetry. */
void port_send(double time_s, uint32_t refused, const poinsot_onboard_answer *answer);

/* Around what is measured. */
void port_perf_entry(port_perf what);
void port_perf_exit(port_perf what);

#endif
