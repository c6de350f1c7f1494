/* The example on a desktop. */
#include "app.h"
#include "bench.h"
#include "port.h"
#include <stdio.h>

void bench_write(const char *text)
{
    fputs(text, stdout);
}

void port_perf_entry(port_perf what)
{
    (void)what;
}

void port_perf_exit(port_perf what)
{
    (void)what;
}

int main(void)
{
    return (int)app_main();
}
