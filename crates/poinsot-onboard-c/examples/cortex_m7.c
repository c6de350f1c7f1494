/* The example on an emulated Cortex-M7 without an operating system: start, text by semihosting, and what the run took.
 *
 * QEMU with -icount shift=0 gives each instruction one nanosecond; timer 0 of the board counts at 25 MHz, so one count is 40
 * instructions. */
#include "app.h"
#include "bench.h"
#include "port.h"

enum { INSTRUCTIONS_PER_COUNT = 40 };
enum { SYS_WRITE0 = 0x04, SYS_EXIT_EXTENDED = 0x20, APPLICATION_EXIT = 0x20026 };
enum { PAINT = 0x5AFE57AC };

#define TIMER_CONTROL (*(volatile uint32_t *)0x40000000u)
#define TIMER_VALUE (*(volatile uint32_t *)0x40000004u)
#define TIMER_RELOAD (*(volatile uint32_t *)0x40000008u)
#define COPROCESSOR_ACCESS (*(volatile uint32_t *)0xE000ED88u)

extern uint32_t bss_begin[], bss_end[], stack_top[];

/* Instructions of the longest call, and of those after it: that of push replays the first window. */
typedef struct {
    uint32_t begin, calls;
    uint64_t longest, total, most;
} perf;
static perf log_of[PORT_PERF_COUNT];

static uint32_t semihosting(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;

    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static void leave(uint32_t code)
{
    const uint32_t block[2] = {APPLICATION_EXIT, code};

    (void)semihosting(SYS_EXIT_EXTENDED, block);
    for (;;) {
    }
}

void bench_write(const char *text)
{
    (void)semihosting(SYS_WRITE0, text);
}

void port_perf_entry(port_perf what)
{
    log_of[what].begin = TIMER_VALUE;
}

/* The timer counts down. */
void port_perf_exit(port_perf what)
{
    perf *of = &log_of[what];
    uint64_t took = (uint64_t)(of->begin - TIMER_VALUE) * INSTRUCTIONS_PER_COUNT;

    if (took > of->longest) {
        of->longest = took;
        of->calls = 0;
        of->total = 0;
        of->most = 0;
        return;
    }
    of->calls++;
    of->total += took;
    of->most = took > of->most ? took : of->most;
}

static void write_number(const char *name, uint64_t number)
{
    char text[21];
    int at = 20;

    text[at] = '\0';
    do {
        text[--at] = (char)('0' + number % 10);
        number /= 10;
    } while (number > 0);
    bench_write("# ");
    bench_write(name);
    bench_write(" ");
    bench_write(&text[at]);
    bench_write("\n");
}

static void run(void)
{
    const uint32_t *low = bss_end;
    const perf *push = &log_of[PORT_PERF_PUSH];

    TIMER_RELOAD = UINT32_MAX;
    TIMER_VALUE = UINT32_MAX;
    TIMER_CONTROL = 1;
    int32_t code = app_main();
    while (*low == PAINT) {
        low++;
    }
    write_number("filter_bytes", poinsot_onboard_size());
    write_number("stack_bytes", (uint64_t)(stack_top - low) * sizeof *low);
    write_number("push_replay", push->longest);
    write_number("push_mean", push->calls > 0 ? push->total / push->calls : 0);
    write_number("push_most", push->most);
    write_number("read_most", log_of[PORT_PERF_READ].longest);
    leave((uint32_t)code);
}

/* Static memory to zero, the stack to a pattern, the floating point unit on. */
void reset(void)
{
    COPROCESSOR_ACCESS |= 0xFu << 20;
    __asm__ volatile("dsb\n isb");
    for (volatile uint32_t *p = bss_begin; p < bss_end; p++) {
        *p = 0;
    }
    uint32_t *sp;
    __asm__ volatile("mov %0, sp" : "=r"(sp));
    for (volatile uint32_t *p = bss_end; p < sp; p++) {
        *p = PAINT;
    }
    run();
}

static void fault(void)
{
    bench_write("fault\n");
    leave(3);
}

/* Stack, reset, and the faults. */
typedef struct {
    uint32_t *stack;
    void (*handlers[15])(void);
} vector_table;

__attribute__((section(".vectors"), used)) static const vector_table vectors = {
    stack_top, {reset, fault, fault, fault, fault, fault},
};
