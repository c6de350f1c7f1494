/* Test only: makes the n-th call that changes a file fail, or kills the process there. Loaded by LD_PRELOAD.
 *   FAULT_AT=n        counted from 1
 *   FAULT_HOW=enospc | eio | kill | int | term | hup; after a signal that is caught the call is made
 *   FAULT_ONCE=1      only this call; else it and all later ones
 *   FAULT_FIRED=path  is made when it happens
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
    return getenv("THREADS_FAIL") ? EAGAIN : REAL(pthread_create)(t, a, f, x);
}
