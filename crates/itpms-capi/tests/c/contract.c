/* Every promise of itpms.h that a test can hold it to, without a log: error codes, text, calibration, state, wheel speeds. Prints what
 * does not hold, with its line, and ends with how much that is. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "holds.h"

typedef union {
    unsigned char bytes[ITPMS_CAR_MAX_SIZE];
    double for_doubles;
    void *for_pointers;
} memory;

static memory first, second;
static const double rate_hz = 500.0;

/* The paper's corner at four wheels. */
static void describe(itpms_config *config)
{
    GIVES(itpms_config_init(config, sizeof *config), OK);
    config->sample_rate_hz = rate_hz;
    config->wheelbase_m = (itpms_real)2.7;
    for (int i = 0; i < 4; i++) {
        itpms_corner_config *corner = &config->corners[i];
        corner->is_measured = 1;
        corner->sprung_mass_kg = (itpms_real)240.8;
        corner->unsprung_mass_kg = (itpms_real)56.9;
        corner->damping_n_s_per_m = (itpms_real)925.8;
        corner->spring_n_per_m = (itpms_real)29114.0;
        corner->stiffness_per_kpa = (itpms_real)713.91;
        corner->stiffness_at_zero = (itpms_real)60880.0;
        corner->placard_kpa = (itpms_real)241.3;
    }
}

/* Noise through a low-pass at every wheel, as the road's. */
static itpms_sample shaken(long k)
{
    static itpms_real wheel[4];
    itpms_sample sample;
    sample.time_s = (double)k / rate_hz;
    sample.speed_m_s = (itpms_real)20.0;
    for (int i = 0; i < 4; i++) {
        wheel[i] = (itpms_real)0.8 * wheel[i] + (itpms_real)4.0 * noise();
        sample.wheel_accel_m_s2[i] = wheel[i];
        sample.body_accel_m_s2[i] = (itpms_real)0.1 * sample.wheel_accel_m_s2[i] + (itpms_real)0.2 * noise();
    }
    return sample;
}

static void texts(void)
{
    HOLDS(strlen(itpms_version()) >= 5);
    HOLDS(strcmp(itpms_status_text(ITPMS_STATUS_OK), "done") == 0);
    for (uint32_t status = 0; status < 19; status++) {
        HOLDS(strcmp(itpms_status_text(status), itpms_status_text(99)) != 0);
        for (uint32_t other = 0; other < status; other++) {
            HOLDS(strcmp(itpms_status_text(status), itpms_status_text(other)) != 0);
        }
    }
    HOLDS(itpms_car_size() <= ITPMS_CAR_MAX_SIZE);
    HOLDS(sizeof(memory) % itpms_car_align() == 0 && itpms_car_align() <= sizeof(double));
}

static void refused(itpms_config *config, const char *parameter, uint32_t corner, itpms_status expected)
{
    itpms_car *car = NULL;
    itpms_problem problem;
    itpms_status status = itpms_car_init(&first, sizeof first, config, &car, &problem);
    if (status != expected || strcmp(problem.parameter, parameter) != 0 || problem.corner != corner || car != NULL) {
        (void)printf("refused %s of corner %u, expected %s of %u: %s\n", problem.parameter, (unsigned)problem.corner, parameter,
                     (unsigned)corner, itpms_status_text(status));
        broken++;
    }
    HOLDS(strlen(problem.expected) > 0);
    describe(config);
}

static void configurations(void)
{
    itpms_config config;
    itpms_car *car = NULL;
    const itpms_real nan = (itpms_real)NAN;
    describe(&config);
    GIVES(itpms_config_init(NULL, sizeof config), NULL_POINTER);
    GIVES(itpms_config_init(&config, sizeof config - 4), WRONG_SIZE);
    GIVES(itpms_car_init(NULL, sizeof first, &config, &car, NULL), NULL_POINTER);
    GIVES(itpms_car_init(&first, sizeof first, NULL, &car, NULL), NULL_POINTER);
    GIVES(itpms_car_init(&first, sizeof first, &config, NULL, NULL), NULL_POINTER);
    GIVES(itpms_car_init(first.bytes + 1, sizeof first - 1, &config, &car, NULL), MISALIGNED);
    GIVES(itpms_car_init(&first, itpms_car_size() - 1, &config, &car, NULL), TOO_SMALL);
    GIVES(itpms_car_init(&first, sizeof first, &config, &car, (itpms_problem *)(void *)(second.bytes + 1)), MISALIGNED);
    config.struct_size--;
    GIVES(itpms_car_init(&first, sizeof first, &config, &car, NULL), WRONG_SIZE);
    config.struct_size++;
    config.api_version++;
    GIVES(itpms_car_init(&first, sizeof first, &config, &car, NULL), WRONG_VERSION);
    describe(&config);

    config.sample_rate_hz = NAN, refused(&config, "sample_rate_hz", 4, ITPMS_STATUS_BAD_PARAMETER);
    config.sample_rate_hz = 0.0, refused(&config, "sample_rate_hz", 4, ITPMS_STATUS_BAD_PARAMETER);
    config.sample_rate_hz = 25.0, refused(&config, "sample_rate_hz", 4, ITPMS_STATUS_BAD_PARAMETER);
    config.sample_rate_hz = 90.0, refused(&config, "sample_rate_hz", 4, ITPMS_STATUS_BAD_PARAMETER);
    config.sample_rate_hz = 2500.0, refused(&config, "sample_rate_hz", 4, ITPMS_STATUS_BAD_PARAMETER);
    config.corners[0].sprung_mass_kg = (itpms_real)1e38, refused(&config, "sprung_mass_kg", 0, ITPMS_STATUS_BAD_PARAMETER);
    config.wheelbase_m = (itpms_real)1e38, refused(&config, "wheelbase_m", 4, ITPMS_STATUS_BAD_PARAMETER);
    config.wheelbase_m = -1, refused(&config, "wheelbase_m", 4, ITPMS_STATUS_BAD_PARAMETER);
    config.corners[2].sprung_mass_kg = nan, refused(&config, "sprung_mass_kg", 2, ITPMS_STATUS_BAD_PARAMETER);
    config.corners[0].unsprung_mass_kg = 0, refused(&config, "unsprung_mass_kg", 0, ITPMS_STATUS_BAD_PARAMETER);
    config.corners[3].stiffness_per_kpa = nan, refused(&config, "stiffness_per_kpa", 3, ITPMS_STATUS_BAD_PARAMETER);
    config.corners[1].placard_kpa = (itpms_real)INFINITY, refused(&config, "placard_kpa", 1, ITPMS_STATUS_BAD_PARAMETER);
    config.corners[1].friction_sd_n = -2, refused(&config, "friction_sd_n", 1, ITPMS_STATUS_BAD_PARAMETER);
    config.corners[0].is_measured = 2, refused(&config, "is_measured", 0, ITPMS_STATUS_BAD_CHOICE);
    config.confidence = 3, refused(&config, "confidence", 4, ITPMS_STATUS_BAD_CHOICE);
    config.regulation = 7, refused(&config, "regulation", 4, ITPMS_STATUS_BAD_CHOICE);
    config.home_altitude_m = 9000, refused(&config, "home_altitude_m", 4, ITPMS_STATUS_BAD_PARAMETER);
    config.loss_share = (itpms_real)0.6, refused(&config, "loss_share", 4, ITPMS_STATUS_BAD_PARAMETER);
    describe_wheel_speeds(&config);
    config.wheel_speeds.track_rear_m = nan, refused(&config, "track_rear_m", 4, ITPMS_STATUS_BAD_PARAMETER);
    for (int i = 0; i < 4; i++) {
        config.corners[i].is_measured = 0;
    }
    refused(&config, "is_measured", 4, ITPMS_STATUS_BAD_CHOICE);

    /* What could not be made is no car. */
    config.confidence = 3;
    memset(&first, 0, sizeof first);
    (void)itpms_car_init(&first, sizeof first, &config, &car, NULL);
    GIVES(itpms_car_reset((itpms_car *)&first), NOT_A_CAR);
    memset(&first, 0xa5, sizeof first);
    GIVES(itpms_car_reset((itpms_car *)&first), NOT_A_CAR);
    HOLDS(itpms_car_state_size((itpms_car *)&first) == 0);
}

static itpms_car *made(memory *where, const itpms_config *config)
{
    itpms_car *car = NULL;
    /* Whatever lay there. */
    memset(where, 0x5a, sizeof *where);
    GIVES(itpms_car_init(where, sizeof *where, config, &car, NULL), OK);
    return car;
}

static void samples(void)
{
    itpms_config config;
    itpms_estimate estimate;
    itpms_sample sample = shaken(0);
    itpms_cold_report cold;
    const itpms_air air = {-10, (itpms_real)101.3, (itpms_real)NAN};
    itpms_car *car;
    size_t count = 99;
    describe(&config);
    car = made(&first, &config);
    GIVES(itpms_car_estimate(car, &estimate), OK);
    HOLDS(isnan(estimate.time_s) && isnan(estimate.wheels[0].pressure_kpa));
    GIVES(itpms_car_update(NULL, &sample, NULL), NULL_POINTER);
    GIVES(itpms_car_update(car, NULL, NULL), NULL_POINTER);
    GIVES(itpms_car_update(car, (itpms_sample *)(void *)((char *)&sample + 1), NULL), MISALIGNED);
    sample.time_s = NAN;
    GIVES(itpms_car_update(car, &sample, NULL), BAD_TIME);
    sample.time_s = INFINITY;
    GIVES(itpms_car_update(car, &sample, NULL), BAD_TIME);
    sample = shaken(1);
    GIVES(itpms_car_update(car, &sample, &estimate), OK);
    HOLDS(estimate.time_s == sample.time_s && estimate.wheels[3].is_monitored == 1);
    HOLDS(estimate.wheels[0].validity == ITPMS_VALIDITY_STARTING && estimate.wheels[0].state == ITPMS_STATE_UNKNOWN);
    /* Missing values of all kinds are no error. */
    sample = shaken(2);
    sample.speed_m_s = (itpms_real)NAN;
    for (int i = 0; i < 4; i++) {
        sample.body_accel_m_s2[i] = (itpms_real)NAN;
        sample.wheel_accel_m_s2[i] = (itpms_real)INFINITY;
    }
    GIVES(itpms_car_update(car, &sample, &estimate), OK);
    GIVES(itpms_car_alerts(car, NULL, 0, &count), OK);
    HOLDS(count == 0);
    GIVES(itpms_car_alerts(car, NULL, 0, NULL), NULL_POINTER);
    GIVES(itpms_car_alert_text(car, 0, NULL, 0, NULL), BAD_INDEX);
    GIVES(itpms_car_cold(car, &cold), OK);
    HOLDS(isnan(cold.ambient_temperature_c) && cold.wheels[2].state == ITPMS_COLD_STATE_UNKNOWN);
    HOLDS(isnan(cold.wheels[2].pressure_kpa) && isnan(cold.wheels[2].add_kpa));
    GIVES(itpms_car_update_air(car, NULL), NULL_POINTER);
    GIVES(itpms_car_update_air(NULL, &air), NULL_POINTER);
    GIVES(itpms_car_update_air(car, (itpms_air *)(void *)((char *)&sample + 1)), MISALIGNED);
    GIVES(itpms_car_update_air(car, &air), OK);
    sample = shaken(3);
    GIVES(itpms_car_update(car, &sample, &estimate), OK);
    GIVES(itpms_car_cold(car, NULL), NULL_POINTER);
    GIVES(itpms_car_cold(car, &cold), OK);
    HOLDS(estimate.wheels[0].validity != ITPMS_VALIDITY_VALID && cold.wheels[0].state == ITPMS_COLD_STATE_UNKNOWN);
    GIVES(itpms_car_begin_calibration(car, 0.0), BAD_DURATION);
    GIVES(itpms_car_begin_calibration(car, NAN), BAD_DURATION);
    GIVES(itpms_car_end_calibration(car), NOT_CALIBRATED);
    GIVES(itpms_car_save_calibration(car, &second, sizeof second, &count), NOT_CALIBRATED);
}

/* A sensor that sticks is an event, a sentence and an alert with its bit. */
static void alerts(void)
{
    static itpms_event events[54];
    static itpms_alert standing[27];
    itpms_config config;
    itpms_car *car;
    char text[256], start[8];
    size_t count = 0, length = 0, index = 0;
    int begun = 0;
    describe(&config);
    car = made(&first, &config);
    for (long k = 0; k < 6000; k++) {
        itpms_sample sample = shaken(k);
        sample.wheel_accel_m_s2[1] = k > 2000 ? (itpms_real)1.5 : sample.wheel_accel_m_s2[1];
        GIVES(itpms_car_update(car, &sample, NULL), OK);
        GIVES(itpms_car_events(car, events, 54, &count), OK);
        for (size_t i = 0; i < count; i++) {
            begun += events[i].alert.malfunction == ITPMS_MALFUNCTION_STUCK && events[i].has_begun == 1;
        }
    }
    HOLDS(begun == 1);
    GIVES(itpms_car_alerts(car, standing, 27, &count), OK);
    while (index < count && standing[index].malfunction != ITPMS_MALFUNCTION_STUCK) {
        index++;
    }
    HOLDS(index < count && standing[index].wheels == 2u && standing[index].cause == ITPMS_CAUSE_MALFUNCTION);
    HOLDS(standing[index].sensors == 0x20u && isnan(standing[index].pressure_kpa) && standing[index].since_s > 4.0);
    GIVES(itpms_car_alert_text(car, index, text, sizeof text, &length), OK);
    HOLDS(strncmp(text, "malfunction: fr wheel sensor is stuck", 37) == 0 && length == strlen(text) + 1);
    GIVES(itpms_car_alert_text(car, index, start, sizeof start, &length), TOO_SMALL);
    HOLDS(strcmp(start, "malfunc") == 0 && length == strlen(text) + 1);
    GIVES(itpms_car_alert_text(car, count, text, sizeof text, NULL), BAD_INDEX);
    index = count;
    GIVES(itpms_car_alerts(car, standing, 27, NULL), NULL_POINTER);
    GIVES(itpms_car_alerts(car, NULL, 0, &count), TOO_SMALL);
    HOLDS(count == index);
    /* After a reset it is a new car, and nothing stands. */
    GIVES(itpms_car_reset(car), OK);
    GIVES(itpms_car_alerts(car, NULL, 0, &count), OK);
    HOLDS(count == 0);
}

/* A car that was saved in the middle goes on to the same bits; what is damaged is refused and changes nothing. */
static void states(void)
{
    itpms_config config;
    itpms_estimate a, b;
    itpms_car *car, *other;
    unsigned char *state;
    size_t size, written = 0;
    describe(&config);
    describe_wheel_speeds(&config);
    car = made(&first, &config);
    for (long k = 0; k < 3000; k++) {
        itpms_sample sample = shaken(k);
        GIVES(itpms_car_update(car, &sample, NULL), OK);
    }
    size = itpms_car_state_size(car);
    HOLDS(size > 1000 && size < 2 * (size_t)ITPMS_CAR_MAX_SIZE);
    state = malloc(size);
    GIVES(itpms_car_save_state(car, state, size - 1, &written), TOO_SMALL);
    GIVES(itpms_car_save_state(car, state, size, &written), OK);
    HOLDS(written == size);
    config.corners[0].is_measured = 0;
    other = made(&second, &config);
    state[size / 2] ^= 4u;
    GIVES(itpms_car_restore_state(other, state, size), DAMAGED);
    state[size / 2] ^= 4u;
    GIVES(itpms_car_restore_state(other, state, size - 1), DAMAGED);
    GIVES(itpms_car_load_calibration(other, state, size), OTHER_FORMAT);
    GIVES(itpms_car_restore_state(other, state, size), OK);
    for (long k = 3000; k < 6000; k++) {
        itpms_sample sample = shaken(k);
        GIVES(itpms_car_update(car, &sample, &a), OK);
        GIVES(itpms_car_update(other, &sample, &b), OK);
    }
    HOLDS(a.wheels[0].is_monitored == 1 && !isnan(a.wheels[0].pressure_kpa));
    HOLDS(memcmp(&a, &b, sizeof a) == 0);
    /* A car may be moved while it is not used: its memory is all of it. */
    memset(&second, 0, sizeof second);
    memcpy(&second, &first, itpms_car_size());
    for (long k = 6000; k < 7000; k++) {
        itpms_sample sample = shaken(k);
        GIVES(itpms_car_update(car, &sample, &a), OK);
        GIVES(itpms_car_update((itpms_car *)&second, &sample, &b), OK);
    }
    HOLDS(memcmp(&a, &b, sizeof a) == 0);
    free(state);
}

/* Wheel speeds alone: a calibration that is stored and loaded, and a tire that loses air. */
static void wheel_speeds(void)
{
    itpms_config config;
    itpms_sample shake = shaken(0);
    itpms_wheel_speed_sample sample = rolling(0.0, 1.0);
    const itpms_air air = {-10, (itpms_real)101.3, (itpms_real)NAN};
    itpms_estimate estimate;
    itpms_alert alert;
    itpms_car *car;
    unsigned char stored[ITPMS_CALIBRATION_MAX_SIZE];
    size_t written = 0, count = 0;
    double time_s = 0.0;
    describe(&config);
    car = made(&first, &config);
    GIVES(itpms_car_update_wheel_speeds(car, &sample), NO_WHEEL_SPEEDS);
    for (int i = 0; i < 4; i++) {
        config.corners[i].is_measured = 0;
    }
    config.sample_rate_hz = NAN;
    describe_wheel_speeds(&config);
    car = made(&first, &config);
    GIVES(itpms_car_update(car, &shake, NULL), NO_CORNERS);
    GIVES(itpms_car_update_air(car, &air), NO_CORNERS);
    GIVES(itpms_wheels_reset((itpms_wheels *)(void *)car), NOT_A_CAR);
    sample.time_s = NAN;
    GIVES(itpms_car_update_wheel_speeds(car, &sample), BAD_TIME);
    sample = rolling(0.0, 1.0);
    sample.brake = 3;
    GIVES(itpms_car_update_wheel_speeds(car, &sample), BAD_CHOICE);
    GIVES(itpms_car_begin_calibration(car, 300.0), OK);
    for (; time_s < 310.0; time_s += 0.02) {
        sample = rolling(time_s, 1.0);
        GIVES(itpms_car_update_wheel_speeds(car, &sample), OK);
    }
    GIVES(itpms_car_save_calibration(car, stored, 20, &written), TOO_SMALL);
    GIVES(itpms_car_save_calibration(car, stored, sizeof stored, &written), OK);
    HOLDS(written > 50 && written <= sizeof stored);
    GIVES(itpms_car_reset(car), OK);
    stored[30] ^= 1u;
    GIVES(itpms_car_load_calibration(car, stored, written), DAMAGED);
    stored[30] ^= 1u;
    GIVES(itpms_car_load_calibration(car, stored, written), OK);
    /* 60 % of its pressure is 0.64 % of its radius; loads may have changed since the calibration, so it takes that much. */
    for (; time_s < 900.0; time_s += 0.02) {
        sample = rolling(time_s, 1.0 - 0.007 * log(0.4));
        GIVES(itpms_car_update_wheel_speeds(car, &sample), OK);
    }
    GIVES(itpms_car_estimate(car, &estimate), OK);
    HOLDS(estimate.radius_state == ITPMS_RADIUS_STATE_LOW && estimate.low_wheels == 8u);
    HOLDS(estimate.wheels[3].state == ITPMS_STATE_LOW && estimate.wheels[0].state != ITPMS_STATE_LOW);
    HOLDS(fabs((double)estimate.wheels[3].radius_lost_share - 0.6) < (double)estimate.wheels[3].radius_lost_share_sd);
    HOLDS(isnan(estimate.wheels[3].pressure_kpa));
    GIVES(itpms_car_alerts(car, &alert, 1, &count), OK);
    GIVES(itpms_car_load_calibration(car, stored, written), TOO_LATE);
    HOLDS(count == 1 && alert.cause == ITPMS_CAUSE_DIFFERS && alert.wheels == 8u && alert.wheels_are_known == 1);
}

int main(void)
{
    texts();
    configurations();
    samples();
    alerts();
    states();
    wheel_speeds();
    (void)printf("%d broken\n", broken);
    return broken;
}
