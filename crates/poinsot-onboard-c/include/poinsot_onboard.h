/* Recursive estimate of the mass properties of one body of a vehicle, for on-board software (C99).
 *
 * Frames, points and units: B is the body frame of the base with origin Bo, N an inertial frame; SI units; quaternions are
 * x, y, z, w of R_NB, which turns components in B into components in N.
 *
 * No function allocates, blocks or calls back. A filter is used by one thread at a time; different filters are independent.
 * Pointers must be those of objects of the declared type. Integers and doubles have the byte order of the target. */
#ifndef POINSOT_ONBOARD_H
#define POINSOT_ONBOARD_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* An error of the library itself ends in an endless loop on bare metal, for the watchdog, and aborts on a desktop. */

/* Version of this interface; poinsot_onboard_version() is that of the library. */
#define POINSOT_ONBOARD_VERSION 4
/* Bytes of a table, from `poinsot export MODEL --to onboard`. */
#define POINSOT_ONBOARD_TABLE 8892
/* Most wheels. */
#define POINSOT_ONBOARD_WHEELS 8
/* Most joints. */
#define POINSOT_ONBOARD_JOINTS 7
/* Samples of the first window: from a tenth of it on, pushes at which it has grown by a third replay it, at most 24 times. */
#define POINSOT_ONBOARD_WINDOW 150
/* Bytes of a filter; poinsot_onboard_size() tells how many of them the target needs. */
#define POINSOT_ONBOARD_SIZE 370000

/* Codes of the functions, an int32_t. */
enum {
    POINSOT_ONBOARD_OK = 0,
    /* A sample is not used, and the filter is as before. */
    POINSOT_ONBOARD_NOT_FINITE = 1, /* a number is NaN or infinite */
    POINSOT_ONBOARD_QUATERNION = 2, /* the quaternion has not length one */
    POINSOT_ONBOARD_DUPLICATE = 3,  /* a sample of the same time was taken */
    POINSOT_ONBOARD_LATE = 4,       /* older than the samples that are held back */
    POINSOT_ONBOARD_CLOCK_JUMP = 5, /* further from the newest than the longest gap; the third in a row is taken */
    /* Arguments. */
    POINSOT_ONBOARD_NULL = 16,            /* a pointer is null */
    POINSOT_ONBOARD_MEMORY = 17,          /* memory too small, or not aligned as a double */
    POINSOT_ONBOARD_NOT_INITIALISED = 18, /* no filter in this memory */
    /* The table is refused, and there is no filter. */
    POINSOT_ONBOARD_TABLE_LENGTH = 32,     /* another number of bytes */
    POINSOT_ONBOARD_TABLE_MAGIC = 33,      /* it does not begin as a table does */
    POINSOT_ONBOARD_TABLE_VERSION = 34,    /* a version that the library does not know */
    POINSOT_ONBOARD_TABLE_CHECKSUM = 35,   /* a byte changed */
    POINSOT_ONBOARD_CAPACITY = 36,         /* it needs more columns than the library has room for */
    POINSOT_ONBOARD_TABLE_NOT_FINITE = 37, /* a number is NaN or infinite */
    POINSOT_ONBOARD_COUNT = 38,            /* too many wheels, joints or samples held back; no such link */
    POINSOT_ONBOARD_NOISE = 39,            /* a noise, a limit or a spin inertia is out of range */
    POINSOT_ONBOARD_AXIS = 40,             /* an axis or a quaternion has not length one */
    POINSOT_ONBOARD_PRIOR = 41,            /* the prior of an unknown number is not positive */
    POINSOT_ONBOARD_UNPHYSICAL = 42,       /* the nominal vehicle has no positive mass or inertia */
    POINSOT_ONBOARD_NEEDS_POSITION = 43,   /* mass or first moment unknown, no position measured, no joint */
    POINSOT_ONBOARD_MODE = 44              /* a mode's frequency, damping or slope of inertia is out of range */
};

/* What the numbers are worth: poinsot_onboard_answer.health. */
enum {
    POINSOT_ONBOARD_CONVERGING = 0,   /* not all unknown parameters are determined yet */
    POINSOT_ONBOARD_DETERMINED = 1,   /* all are, and the innovations are those of the declared noise */
    POINSOT_ONBOARD_INCONSISTENT = 2, /* the innovations are not; no number counts */
    POINSOT_ONBOARD_STALE = 3         /* no sample for longer than the table says */
};

/* Bits of poinsot_onboard_sample.measured; other bits are not read. */
enum {
    POINSOT_ONBOARD_GYRO = 1,
    POINSOT_ONBOARD_ATTITUDE = 2,
    POINSOT_ONBOARD_POSITION = 4
};

/* Memory of a filter, static in most programs. Its contents are private. */
typedef struct {
    double private_memory[POINSOT_ONBOARD_SIZE / 8];
} poinsot_onboard;

/* What is measured at one time, and what acts until the next. */
typedef struct {
    double time_s;
    double gyro[3];                             /* angular velocity in B, rad/s */
    double attitude[4];                         /* R_NB, x, y, z, w */
    double position[3];                         /* of Bo in N, m */
    double wheel_speed[POINSOT_ONBOARD_WHEELS]; /* relative to the base, rad/s; those beyond the number of wheels are not read */
    double joint_position[POINSOT_ONBOARD_JOINTS]; /* rad or m; those beyond the number of joints are not read */
    double joint_rate[POINSOT_ONBOARD_JOINTS];     /* rad/s or m/s */
    double force_B[3];                          /* of the thrusters until the next sample, in B, N */
    double torque_B[3];                         /* their torque about Bo, in B, N m */
    uint32_t measured;                          /* which of gyro, attitude and position this sample has */
    uint32_t reserved;                          /* not read */
} poinsot_onboard_sample;

/* What the filter knows. The parameters are, about the origin of the unknown body in its axes (the base: Bo and B): m; mc x, y, z; I xx, xy, yy, xz, yz, zz (kg, kg m, kg m2;
 * xy, xz, yz are elements of the tensor). */
typedef struct {
    double value[10];          /* those of a physical body */
    double sigma[10];          /* one sigma; zero where known */
    double covariance[10][10]; /* of the unknown ones, in the same order: the first rows and columns */
    uint64_t accepted[3];      /* measurements of gyro, attitude, position that were used */
    uint64_t gated[3];         /* those left out, since their innovation was no noise */
    uint32_t health;
    uint32_t determined; /* bit k: value[k] is determined by the data, and the filter is consistent */
    uint32_t unknowns;   /* number of unknown parameters */
    uint32_t reserved;   /* zero */
} poinsot_onboard_answer;

/* Version of the library: compare it with POINSOT_ONBOARD_VERSION. */
uint32_t poinsot_onboard_version(void);

/* Bytes that a filter needs on this target. */
size_t poinsot_onboard_size(void);

/* Makes a filter of a table; size is that of the memory, length that of the table. A filter that was there begins anew. */
int32_t poinsot_onboard_init(poinsot_onboard *filter, size_t size, const uint8_t *table, size_t length);

/* Takes a sample and makes the step that it asks for. */
int32_t poinsot_onboard_push(poinsot_onboard *filter, const poinsot_onboard_sample *sample);

/* Takes the samples that are held back to be put in order, at the end of a stream. */
int32_t poinsot_onboard_flush(poinsot_onboard *filter);

/* Writes what is known at a time on the clock of the samples, s. */
int32_t poinsot_onboard_read(poinsot_onboard *filter, double time_s, poinsot_onboard_answer *answer);

#ifdef __cplusplus
}
#endif

#endif
