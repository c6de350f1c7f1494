/* Test only: makes the n-th call that changes a file fail, or kills the process there. Loaded by LD_PRELOAD.
 *   FAULT_AT=n        counted from 1
 *   FAULT_HOW=enospc | eio | kill | int | term | hup; after a signal that is caught the call is made
 *   FAULT_ONCE=1      only this call; else it and all later ones
 *   FAULT_FIRED=path  is made when it happens
 * makes the n-th allocation fail:
 *   ALLOC_AT=n        counted from 1, from the first thread on
 *   ALLOC_COUNT=path  gets the number of allocations of the whole run
 * and counts threads:
 *   THREADS_LOG=path  grows by a byte for each thread that is started
 *   THREADS_FAIL=1    no thread can be started
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

static long calls;

static int strikes(void)
{
    const char *at = getenv("FAULT_AT"), *how = getenv("FAULT_HOW"), *fired = getenv("FAULT_FIRED");
    if (!at || !how)
        return 0;
    long n = atol(at), now = __sync_add_and_fetch(&calls, 1);
    if (now < n || (now > n && getenv("FAULT_ONCE")))
        return 0;
    if (fired) {
        long fd = syscall(SYS_openat, AT_FDCWD, fired, O_CREAT | O_WRONLY, 0644);
        if (fd >= 0)
            syscall(SYS_close, fd);
    }
    if (!strcmp(how, "kill"))
        kill(getpid(), SIGKILL);
    int caught = !strcmp(how, "int") ? SIGINT : !strcmp(how, "term") ? SIGTERM : !strcmp(how, "hup") ? SIGHUP : 0;
    if (caught) {
        kill(getpid(), caught);
        usleep(20000);
        return 0;
    }
    errno = !strcmp(how, "eio") ? EIO : ENOSPC;
    return 1;
}

/* Counted once the program has started a thread: then its signals are handled. */
static long allocations = -1;

static int no_memory(void)
{
    if (allocations < 0)
        return 0;
    static long at = -1;
    if (at < 0) {
        const char *text = getenv("ALLOC_AT");
        at = text ? atol(text) : 0;
    }
    if (__sync_add_and_fetch(&allocations, 1) != at)
        return 0;
    errno = ENOMEM;
    return 1;
}

extern void *__libc_malloc(size_t), *__libc_calloc(size_t, size_t), *__libc_realloc(void *, size_t);
void *malloc(size_t n) { return no_memory() ? 0 : __libc_malloc(n); }
void *calloc(size_t n, size_t size) { return no_memory() ? 0 : __libc_calloc(n, size); }
void *realloc(void *p, size_t n) { return no_memory() ? 0 : __libc_realloc(p, n); }

__attribute__((destructor)) static void count(void)
{
    const char *path = getenv("ALLOC_COUNT");
    char text[32], *end = text + sizeof text, *first = end;
    if (!path)
        return;
    for (long n = allocations; first > text && n > 0; n /= 10)
        *--first = (char)('0' + n % 10);
    long fd = syscall(SYS_openat, AT_FDCWD, path, O_CREAT | O_WRONLY | O_TRUNC, 0644);
    if (fd >= 0) {
        syscall(SYS_write, fd, first, (size_t)(end - first));
        syscall(SYS_close, fd);
    }
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

ssize_t write(int fd, const void *b, size_t n) { return fd > 2 && strikes() ? -1 : REAL(write)(fd, b, n); }
ssize_t writev(int fd, const struct iovec *v, int n) { return fd > 2 && strikes() ? -1 : REAL(writev)(fd, v, n); }
int fsync(int fd) { return strikes() ? -1 : REAL(fsync)(fd); }
int fdatasync(int fd) { return strikes() ? -1 : REAL(fdatasync)(fd); }
int rename(const char *a, const char *b) { return strikes() ? -1 : REAL(rename)(a, b); }
int renameat(int d, const char *a, int e, const char *b) { return strikes() ? -1 : REAL(renameat)(d, a, e, b); }
int link(const char *a, const char *b) { return strikes() ? -1 : REAL(link)(a, b); }
int linkat(int d, const char *a, int e, const char *b, int f)
{
    return strikes() ? -1 : REAL(linkat)(d, a, e, b, f);
}
int mkdir(const char *p, mode_t m) { return strikes() ? -1 : REAL(mkdir)(p, m); }

static int creates(int flags) { return flags & O_CREAT; }

#define OPEN(name, ...)                                                                                        \
    mode_t mode = 0;                                                                                           \
    if (creates(flags)) {                                                                                      \
        va_list list;                                                                                          \
        va_start(list, flags);                                                                                 \
        mode = va_arg(list, mode_t);                                                                           \
        va_end(list);                                                                                          \
        if (strikes())                                                                                         \
            return -1;                                                                                         \
    }                                                                                                          \
    return REAL(name)(__VA_ARGS__, flags, mode);

int open(const char *p, int flags, ...) { OPEN(open, p) }
int open64(const char *p, int flags, ...) { OPEN(open64, p) }
int openat(int d, const char *p, int flags, ...) { OPEN(openat, d, p) }
int openat64(int d, const char *p, int flags, ...) { OPEN(openat64, d, p) }

int pthread_create(pthread_t *t, const pthread_attr_t *a, void *(*f)(void *), void *x)
{
    const char *log = getenv("THREADS_LOG");
    if (log) {
        long fd = syscall(SYS_openat, AT_FDCWD, log, O_CREAT | O_WRONLY | O_APPEND, 0644);
        if (fd >= 0) {
            syscall(SYS_write, fd, "1", 1);
            syscall(SYS_close, fd);
        }
    }
    __sync_bool_compare_and_swap(&allocations, -1, 0);
    return getenv("THREADS_FAIL") ? EAGAIN : REAL(pthread_create)(t, a, f, x);
}
