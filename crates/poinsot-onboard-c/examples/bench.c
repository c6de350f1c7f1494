/* Table and samples are linked from files; housekeeping is asked for after each fifth sample. Numbers are printed as the 16
 * hexadecimal digits of their bits, so that desktop and target can be compared without a loss. */
#include "bench.h"
#include "port.h"

enum { SAMPLES_PER_HOUSEKEEPING = 5 };

extern const uint8_t bench_table[], bench_table_end[];
extern const poinsot_onboard_sample bench_flight[], bench_flight_end[];

const uint8_t *port_table(size_t *length)
{
    *length = (size_t)(bench_table_end - bench_table);
    return bench_table;
}

int port_receive(port_message *message)
{
    static const poinsot_onboard_sample *next = bench_flight;
    static uint32_t waiting;

    if (waiting == SAMPLES_PER_HOUSEKEEPING) {
        waiting = 0;
        message->kind = PORT_HOUSEKEEPING;
        return 1;
    }
    if (next == bench_flight_end) {
        return 0;
    }
    message->kind = PORT_SAMPLE;
    message->sample = *next++;
    waiting++;
    return 1;
}

static void write_word(uint32_t word)
{
    static const char digits[] = "0123456789abcdef";
    char text[9];

    for (int k = 0; k < 8; k++) {
        text[k] = digits[(word >> (28 - 4 * k)) & 15u];
    }
    text[8] = '\0';
    bench_write(text);
}

static void write_double(double number)
{
    union {
        double number;
        uint64_t bits;
    } as = {number};

    bench_write(" ");
    write_word((uint32_t)(as.bits >> 32));
    write_word((uint32_t)as.bits);
}

void port_send(double time_s, uint32_t refused, const poinsot_onboard_answer *answer)
{
    write_word(answer->health);
    bench_write(" ");
    write_word(answer->determined);
    bench_write(" ");
    write_word(refused);
    write_double(time_s);
    for (int k = 0; k < 10; k++) {
        write_double(answer->value[k]);
        write_double(answer->sigma[k]);
    }
    bench_write("\n");
}
