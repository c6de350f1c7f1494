/* A flight application around the filter, in the shape of a cFS application: initialise once, then take messages from the
 * software bus until the executive stops. It needs no operating system; what a platform must give is in port.h. */
#include "app.h"
#include "poinsot_onboard.h"
#include "port.h"

/* Static memory: neither the application nor the library has a heap. */
static poinsot_onboard filter;
static uint32_t refused;

static int32_t app_init(void)
{
    size_t length;
    const uint8_t *table = port_table(&length);

    if (poinsot_onboard_version() != POINSOT_ONBOARD_VERSION) {
        return POINSOT_ONBOARD_NOT_INITIALISED;
    }
    refused = 0;
    return poinsot_onboard_init(&filter, sizeof filter, table, length);
}

/* A sample of gyro, tracker, position and wheels. */
static void app_sample(const poinsot_onboard_sample *sample)
{
    port_perf_entry(PORT_PERF_PUSH);
    if (poinsot_onboard_push(&filter, sample) != POINSOT_ONBOARD_OK) {
        /* The filter is as before; what follows from many refusals shows in its health. */
        refused++;
    }
    port_perf_exit(PORT_PERF_PUSH);
}

/* Housekeeping is asked for: numbers count only where their bit in `determined` is set. */
static void app_housekeeping(double now_s)
{
    static poinsot_onboard_answer answer;

    port_perf_entry(PORT_PERF_READ);
    int32_t code = poinsot_onboard_read(&filter, now_s, &answer);
    port_perf_exit(PORT_PERF_READ);
    if (code == POINSOT_ONBOARD_OK) {
        port_send(now_s, refused, &answer);
    }
}

int32_t app_main(void)
{
    static port_message message;

    int32_t code = app_init();
    if (code != POINSOT_ONBOARD_OK) {
        return code;
    }
    while (port_receive(&message)) {
        switch (message.kind) {
        case PORT_SAMPLE:
            app_sample(&message.sample);
            break;
        case PORT_HOUSEKEEPING:
            app_housekeeping(message.sample.time_s);
            break;
        default:
            break;
        }
    }
    return POINSOT_ONBOARD_OK;
}
