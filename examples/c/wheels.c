/* Reads a log of four wheel speeds (CSV) and prints twice a second what each tire has lost since the calibration, and what is warned of.
 *
 *     wheels LOG.csv CAR.toml CALIBRATE_S > est.csv
 *
 * The columns are those of `itpms lab simulate`, in its order. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "itpms.h"
#include "vehicle_file.h"

static const char *const states[6] = { "unknown", "fine", "low", "over", "malfunction", "uncertain" };

static double memory[ITPMS_WHEELS_MAX_SIZE / sizeof(double)];

/* time_s, speed_m_s, four wheel speeds, yaw_rate_rad_s, accel_x_m_s2, accel_y_m_s2, brake; an empty cell is a missing value. */
static int read_sample(FILE *log, itpms_wheel_speed_sample *sample)
{
    char line[512];
    const char *at = fgets(line, sizeof line, log);
    double cells[10];
    int column = 0;
    for (; column < 10 && at != NULL; column++) {
        char *end;
        double value = strtod(at, &end);
        cells[column] = end == at ? NAN : value;
        at = strchr(end, ',');
        at = at == NULL ? NULL : at + 1;
    }
    if (column < 10) {
        return 0;
    }
    sample->time_s = cells[0];
    for (int wheel = 0; wheel < 4; wheel++) {
        sample->wheel_speed_m_s[wheel] = (itpms_real)cells[2 + wheel];
    }
    sample->yaw_rate_rad_s = (itpms_real)cells[6];
    sample->accel_x_m_s2 = (itpms_real)cells[7];
    sample->accel_y_m_s2 = (itpms_real)cells[8];
    sample->brake = isnan(cells[9]) ? ITPMS_BRAKE_UNKNOWN : cells[9] > 0.0 ? ITPMS_BRAKE_ON : ITPMS_BRAKE_OFF;
    return 1;
}

static int failed(const char *what, itpms_status status)
{
    (void)fprintf(stderr, "%s: %s\n", what, itpms_status_text(status));
    return EXIT_FAILURE;
}

static int drive(FILE *log, itpms_wheels *wheels)
{
    itpms_wheel_speed_sample sample;
    itpms_radius_report report;
    itpms_event events[2];
    char text[256];
    double next_s = -1e300;
    while (read_sample(log, &sample)) {
        size_t count = 0;
        itpms_status status = itpms_wheels_update(wheels, &sample, &report);
        if (status != ITPMS_STATUS_OK) {
            return failed("a sample", status);
        }
        if (itpms_wheels_events(wheels, events, 2, &count) == ITPMS_STATUS_OK && count > 0 &&
            itpms_wheels_alert_text(wheels, 0, text, sizeof text, NULL) == ITPMS_STATUS_OK) {
            (void)fprintf(stderr, "%s\n", text);
        }
        if (sample.time_s >= next_s) {
            (void)printf("%.9g", report.time_s);
            for (int i = 0; i < 4; i++) {
                const itpms_wheel_radius *wheel = &report.wheels[i];
                (void)printf(",%.17g,%.17g,%s", (double)wheel->lost_share, (double)wheel->lost_share_sd, states[wheel->state]);
            }
            (void)printf("\n");
            next_s = sample.time_s + 0.5 - 1e-9;
        }
    }
    return EXIT_SUCCESS;
}

int main(int argc, char **argv)
{
    static char header[512];
    itpms_config config;
    itpms_problem problem;
    itpms_wheels *wheels = NULL;
    itpms_status status;
    FILE *log = argc == 4 ? fopen(argv[1], "r") : NULL;
    (void)itpms_config_init(&config, sizeof config);
    if (log == NULL || vehicle_file_read(argv[2], &config) != 0 || fgets(header, sizeof header, log) == NULL) {
        (void)fprintf(stderr, "usage: wheels LOG.csv CAR.toml CALIBRATE_S\n");
        return EXIT_FAILURE;
    }
    config.wheel_speeds.is_used = 1;
    status = itpms_wheels_init(memory, sizeof memory, &config, &wheels, &problem);
    if (status != ITPMS_STATUS_OK) {
        (void)fprintf(stderr, "%s is %g, expected %s\n", problem.parameter, problem.value, problem.expected);
        return failed("the wheels", status);
    }
    status = itpms_wheels_begin_calibration(wheels, strtod(argv[3], NULL));
    if (status != ITPMS_STATUS_OK) {
        return failed("the calibration", status);
    }
    (void)printf("time_s");
    for (int i = 0; i < 4; i++) {
        static const char *const labels[4] = { "fl", "fr", "rl", "rr" };
        (void)printf(",%s_lost_share,%s_lost_share_sd,%s_state", labels[i], labels[i], labels[i]);
    }
    (void)printf("\n");
    return drive(log, wheels);
}
