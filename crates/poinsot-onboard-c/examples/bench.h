/* The bench of the example: a recorded flight in place of a software bus, text in place of telemetry. */
#ifndef BENCH_H
#define BENCH_H

/* Writes text: the one thing that desktop and target do in their own way, beside port_perf. */
void bench_write(const char *text);

#endif
