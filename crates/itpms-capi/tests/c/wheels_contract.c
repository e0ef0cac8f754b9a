/* The promises of itpms.h for wheel speeds alone, as contract.c has them for a car. */
#include <string.h>

#include "holds.h"

typedef union {
    unsigned char bytes[ITPMS_WHEELS_MAX_SIZE];
    double for_doubles;
} memory;

static memory first, second;
static double time_s = 0.0;

static void describe(itpms_config *config)
{
    GIVES(itpms_config_init(config, sizeof *config), OK);
    config->wheelbase_m = (itpms_real)2.7;
    describe_wheel_speeds(config);
}

static itpms_wheels *made(memory *where, const itpms_config *config)
{
    itpms_wheels *wheels = NULL;
    /* Whatever lay there. */
    memset(where, 0x5a, sizeof *where);
    GIVES(itpms_wheels_init(where, sizeof *where, config, &wheels, NULL), OK);
    return wheels;
}

/* Drives at 50 Hz, the rear right tire with so much of its pressure, at the radius over pressure that is taken as usual. */
static void drive(itpms_wheels *wheels, double until_s, double share)
{
    for (; time_s < until_s; time_s += 0.02) {
        itpms_wheel_speed_sample sample = rolling(time_s, 1.0 - 0.007 * log(share));
        GIVES(itpms_wheels_update(wheels, &sample, NULL), OK);
    }
}

static void refused(itpms_config *config, const char *parameter, itpms_status expected)
{
    itpms_wheels *wheels = NULL;
    itpms_problem problem;
    HOLDS(itpms_wheels_init(&first, sizeof first, config, &wheels, &problem) == expected);
    HOLDS(strcmp(problem.parameter, parameter) == 0 && problem.corner == 4 && strlen(problem.expected) > 0);
    HOLDS(wheels == NULL);
    GIVES(itpms_wheels_reset((itpms_wheels *)&first), NOT_A_CAR);
    describe(config);
}

static void configurations(void)
{
    itpms_config config;
    itpms_wheels *wheels = NULL;
    itpms_car *car = NULL;
    HOLDS(itpms_wheels_size() <= ITPMS_WHEELS_MAX_SIZE && itpms_wheels_size() < itpms_car_size() / 20);
    HOLDS(sizeof(memory) % itpms_wheels_align() == 0 && itpms_wheels_align() <= sizeof(double));
    describe(&config);
    GIVES(itpms_wheels_init(NULL, sizeof first, &config, &wheels, NULL), NULL_POINTER);
    GIVES(itpms_wheels_init(&first, sizeof first, NULL, &wheels, NULL), NULL_POINTER);
    GIVES(itpms_wheels_init(&first, sizeof first, &config, NULL, NULL), NULL_POINTER);
    GIVES(itpms_wheels_init(first.bytes + 1, sizeof first - 1, &config, &wheels, NULL), MISALIGNED);
    GIVES(itpms_wheels_init(&first, itpms_wheels_size() - 1, &config, &wheels, NULL), TOO_SMALL);
    GIVES(itpms_car_init(&first, sizeof first, &config, &car, NULL), TOO_SMALL);
    config.struct_size--;
    GIVES(itpms_wheels_init(&first, sizeof first, &config, &wheels, NULL), WRONG_SIZE);
    describe(&config);
    config.api_version++;
    GIVES(itpms_wheels_init(&first, sizeof first, &config, &wheels, NULL), WRONG_VERSION);
    describe(&config);
    config.wheelbase_m = (itpms_real)NAN, refused(&config, "wheelbase_m", ITPMS_STATUS_BAD_PARAMETER);
    config.wheel_speeds.track_front_m = 0, refused(&config, "track_front_m", ITPMS_STATUS_BAD_PARAMETER);
    config.wheel_speeds.load_rear_axle_sd = -1, refused(&config, "load_rear_axle_sd", ITPMS_STATUS_BAD_PARAMETER);
    config.wheel_speeds.driven = 3, refused(&config, "driven", ITPMS_STATUS_BAD_CHOICE);
    config.wheel_speeds.is_used = 0, refused(&config, "wheel_speeds.is_used", ITPMS_STATUS_BAD_CHOICE);
    /* What is of a car alone is not read. */
    config.confidence = 9;
    config.corners[0].is_measured = 1;
    wheels = made(&first, &config);
    GIVES(itpms_wheels_reset(wheels), OK);
}

static void samples(void)
{
    itpms_config config;
    itpms_radius_report report;
    itpms_wheel_speed_sample sample = rolling(0.0, 1.0);
    itpms_event events[2];
    itpms_wheels *wheels;
    char text[8];
    size_t count = 99;
    describe(&config);
    wheels = made(&first, &config);
    GIVES(itpms_wheels_report(wheels, &report), OK);
    HOLDS(isnan(report.time_s) && isnan(report.wheels[0].lost_share) && report.state == ITPMS_RADIUS_STATE_UNCALIBRATED);
    HOLDS(report.wheels[2].state == ITPMS_STATE_UNKNOWN && report.wheels[2].doubt == ITPMS_DOUBT_STARTING);
    memset(&second, 0xa5, sizeof second);
    GIVES(itpms_wheels_update((itpms_wheels *)&second, &sample, NULL), NOT_A_CAR);
    GIVES(itpms_wheels_update(NULL, &sample, NULL), NULL_POINTER);
    GIVES(itpms_wheels_update(wheels, NULL, NULL), NULL_POINTER);
    GIVES(itpms_wheels_update((itpms_wheels *)(void *)(first.bytes + 1), &sample, NULL), MISALIGNED);
    GIVES(itpms_wheels_update(wheels, (itpms_wheel_speed_sample *)(void *)((char *)&sample + 1), NULL), MISALIGNED);
    GIVES(itpms_wheels_report(wheels, NULL), NULL_POINTER);
    sample.time_s = INFINITY;
    GIVES(itpms_wheels_update(wheels, &sample, NULL), BAD_TIME);
    sample = rolling(0.0, 1.0);
    sample.brake = 3;
    GIVES(itpms_wheels_update(wheels, &sample, NULL), BAD_CHOICE);
    /* Missing values are no error. */
    sample.brake = ITPMS_BRAKE_UNKNOWN;
    sample.wheel_speed_m_s[1] = (itpms_real)NAN;
    sample.yaw_rate_rad_s = (itpms_real)NAN;
    GIVES(itpms_wheels_update(wheels, &sample, &report), OK);
    HOLDS(report.time_s == sample.time_s);
    GIVES(itpms_wheels_alerts(wheels, NULL, 0, &count), OK);
    HOLDS(count == 0);
    GIVES(itpms_wheels_alerts(wheels, NULL, 0, NULL), NULL_POINTER);
    GIVES(itpms_wheels_alert_text(wheels, 0, text, sizeof text, NULL), BAD_INDEX);
    GIVES(itpms_wheels_events(wheels, NULL, 0, &count), NULL_POINTER);
    GIVES(itpms_wheels_events(wheels, events, 2, &count), OK);
    HOLDS(count == 0);
    GIVES(itpms_wheels_begin_calibration(wheels, -1.0), BAD_DURATION);
    GIVES(itpms_wheels_begin_calibration(wheels, NAN), BAD_DURATION);
    GIVES(itpms_wheels_end_calibration(wheels), NOT_CALIBRATED);
    GIVES(itpms_wheels_save_calibration(wheels, &second, sizeof second, &count), NOT_CALIBRATED);
}

/* A quarter is lost in the drive of the calibration: it is warned of within a minute, and taken back once the tire is filled up. */
static void quarter(void)
{
    itpms_config config;
    itpms_radius_report report;
    itpms_event events[2];
    itpms_alert alert;
    itpms_wheels *wheels;
    char text[256], start[8];
    size_t count = 0, length = 0;
    describe(&config);
    time_s = 0.0;
    wheels = made(&first, &config);
    GIVES(itpms_wheels_begin_calibration(wheels, 300.0), OK);
    drive(wheels, 100.0, 1.0);
    GIVES(itpms_wheels_report(wheels, &report), OK);
    HOLDS(report.state == ITPMS_RADIUS_STATE_CALIBRATING);
    drive(wheels, 400.0, 1.0);
    GIVES(itpms_wheels_report(wheels, &report), OK);
    HOLDS(report.state == ITPMS_RADIUS_STATE_NONE_DIFFERS && report.low_wheels == 0u && report.any_low_probability < 0.1);
    for (int i = 0; i < 4; i++) {
        HOLDS(report.wheels[i].state == ITPMS_STATE_FINE && report.wheels[i].is_informed == 1);
    }
    drive(wheels, 460.0, 0.75);
    GIVES(itpms_wheels_events(wheels, events, 0, &count), TOO_SMALL);
    HOLDS(count == 1);
    GIVES(itpms_wheels_events(wheels, events, 2, &count), OK);
    HOLDS(count == 1 && events[0].has_begun == 1 && events[0].alert.cause == ITPMS_CAUSE_DIFFERS);
    GIVES(itpms_wheels_events(wheels, events, 2, &count), OK);
    HOLDS(count == 0);
    GIVES(itpms_wheels_alerts(wheels, NULL, 0, &count), TOO_SMALL);
    GIVES(itpms_wheels_alerts(wheels, &alert, 1, &count), OK);
    HOLDS(count == 1 && alert.wheels == 8u && alert.wheels_are_known == 1 && alert.since_s >= 400.0 && alert.reported_s < 460.0);
    HOLDS(fabs((double)alert.share - 0.25) < (double)alert.share_sd && isnan(alert.pressure_kpa));
    GIVES(itpms_wheels_alert_text(wheels, 0, text, sizeof text, &length), OK);
    HOLDS(strncmp(text, "rr differs from the other tires since the calibration", 53) == 0 && length == strlen(text) + 1);
    GIVES(itpms_wheels_alert_text(wheels, 0, start, sizeof start, &length), TOO_SMALL);
    HOLDS(strcmp(start, "rr diff") == 0 && length == strlen(text) + 1);
    GIVES(itpms_wheels_report(wheels, &report), OK);
    HOLDS(report.state == ITPMS_RADIUS_STATE_LOW && report.low_wheels == 8u);
    HOLDS(report.wheels[3].state == ITPMS_STATE_LOW && report.wheels[0].state == ITPMS_STATE_FINE);
    HOLDS(report.wheels[3].low_probability > 0.99 && report.wheels[3].radius_change < 0);
    HOLDS(fabs((double)report.wheels[3].lost_share - 0.25) < (double)report.wheels[3].lost_share_sd);
    drive(wheels, 1000.0, 1.0);
    GIVES(itpms_wheels_events(wheels, events, 2, &count), OK);
    HOLDS(count == 1 && events[0].has_begun == 0 && events[0].alert.wheels == 8u);
    GIVES(itpms_wheels_alerts(wheels, NULL, 0, &count), OK);
}

/* A calibration is stored and loaded; memory that was copied goes on to the same bits. */
static void calibrations(void)
{
    itpms_config config;
    itpms_radius_report a, b;
    itpms_wheels *wheels;
    unsigned char stored[ITPMS_CALIBRATION_MAX_SIZE];
    size_t written = 0, count = 0;
    describe(&config);
    time_s = 0.0;
    wheels = made(&first, &config);
    GIVES(itpms_wheels_begin_calibration(wheels, 1000.0), OK);
    drive(wheels, 300.0, 1.0);
    GIVES(itpms_wheels_save_calibration(wheels, stored, sizeof stored, &written), NOT_CALIBRATED);
    GIVES(itpms_wheels_end_calibration(wheels), OK);
    GIVES(itpms_wheels_save_calibration(wheels, stored, 20, &written), TOO_SMALL);
    GIVES(itpms_wheels_save_calibration(wheels, stored, sizeof stored, NULL), NULL_POINTER);
    GIVES(itpms_wheels_save_calibration(wheels, stored, sizeof stored, &written), OK);
    /* A header of 16 bytes, eight numbers, their covariance, four radii, whether the yaw rate is left out. */
    HOLDS(written == 16 + (8 + 64 + 4) * sizeof(itpms_real) + 1);
    GIVES(itpms_wheels_reset(wheels), OK);
    stored[30] ^= 1u;
    GIVES(itpms_wheels_load_calibration(wheels, stored, written), DAMAGED);
    stored[30] ^= 1u;
    GIVES(itpms_wheels_load_calibration(wheels, stored, written - 1), DAMAGED);
    stored[2] = 'C';
    GIVES(itpms_wheels_load_calibration(wheels, stored, written), OTHER_FORMAT);
    stored[2] = 'W';
    GIVES(itpms_wheels_load_calibration(wheels, stored, written), OK);
    drive(wheels, 400.0, 1.0);
    memset(&second, 0, sizeof second);
    memcpy(&second, &first, itpms_wheels_size());
    /* Loads may have changed since the calibration, so that it takes more than a quarter. */
    for (; time_s < 900.0; time_s += 0.02) {
        itpms_wheel_speed_sample sample = rolling(time_s, 1.0 - 0.007 * log(0.4));
        GIVES(itpms_wheels_update(wheels, &sample, &a), OK);
        GIVES(itpms_wheels_update((itpms_wheels *)&second, &sample, &b), OK);
    }
    HOLDS(memcmp(&a, &b, sizeof a) == 0);
    HOLDS(a.state == ITPMS_RADIUS_STATE_LOW && a.low_wheels == 8u && a.loads_may_differ == 1);
    GIVES(itpms_wheels_alerts((itpms_wheels *)&second, NULL, 0, &count), TOO_SMALL);
    HOLDS(count == 1);
}

int main(void)
{
    configurations();
    samples();
    quarter();
    calibrations();
    (void)printf("%d broken\n", broken);
    return broken;
}
