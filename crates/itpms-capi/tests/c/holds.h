/* What the promises of itpms.h are held with, and a car's wheel speeds. */
#ifndef HOLDS_H
#define HOLDS_H

#include <math.h>
#include <stdio.h>

#include "itpms.h"

static int broken = 0;

#define HOLDS(what)                                                              \
    do {                                                                         \
        if (!(what)) {                                                           \
            (void)printf("%s:%d: %s does not hold\n", __FILE__, __LINE__, #what); \
            broken++;                                                            \
        }                                                                        \
    } while (0)
#define GIVES(call, status)                                                                                 \
    do {                                                                                                    \
        itpms_status gave = (call);                                                                         \
        if (gave != ITPMS_STATUS_##status) {                                                                \
            (void)printf("%s:%d: %s: %s\n", __FILE__, __LINE__, #call, itpms_status_text(gave));           \
            broken++;                                                                                       \
        }                                                                                                   \
    } while (0)

static inline void describe_wheel_speeds(itpms_config *config)
{
    config->wheel_speeds.is_used = 1;
    config->wheel_speeds.driven = ITPMS_DRIVEN_REAR;
    config->wheel_speeds.track_front_m = (itpms_real)1.55;
    config->wheel_speeds.track_rear_m = (itpms_real)1.55;
}

/* Noise of a known sequence, between -1 and 1: Marsaglia's xorshift. */
static inline itpms_real noise(void)
{
    static uint32_t state = 2463534242u;
    state ^= state << 13;
    state ^= state >> 17;
    state ^= state << 5;
    return (itpms_real)((double)(state >> 8) / 8388608.0 - 1.0);
}

/* At some 20 m/s; the rear right wheel turns so much faster than the others. */
static inline itpms_wheel_speed_sample rolling(double time_s, double rear_right)
{
    itpms_wheel_speed_sample sample;
    sample.time_s = time_s;
    for (int i = 0; i < 4; i++) {
        sample.wheel_speed_m_s[i] = (itpms_real)(20.0 + 2.0 * sin(0.05 * time_s) + 0.01 * (double)noise());
    }
    sample.wheel_speed_m_s[3] *= (itpms_real)rear_right;
    sample.yaw_rate_rad_s = (itpms_real)(0.0005 * (double)noise());
    sample.accel_x_m_s2 = (itpms_real)(0.1 * cos(0.05 * time_s));
    sample.accel_y_m_s2 = (itpms_real)NAN;
    sample.brake = ITPMS_BRAKE_OFF;
    return sample;
}

#endif
