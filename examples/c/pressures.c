/* Reads a drive log (CSV) and prints the pressures of its tires ten times a second, and what the monitor says.
 *
 *     pressures LOG.csv CAR.toml [CALIBRATE_S] > est.csv
 *
 * C99 and nothing but the library: the car lies in memory that is there when the program starts. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "itpms.h"
#include "vehicle_file.h"

#define MOST_COLUMNS 64
#define LONGEST_LINE 4096

static const char *const labels[4] = { "fl", "fr", "rl", "rr" };
static const char *const states[6] = { "unknown", "fine", "low", "over", "malfunction", "uncertain" };

/* Memory of the car: doubles are aligned for whatever it holds. */
static double memory[ITPMS_CAR_MAX_SIZE / sizeof(double)];

static int failed(const char *what, itpms_status status)
{
    (void)fprintf(stderr, "%s: %s\n", what, itpms_status_text(status));
    return EXIT_FAILURE;
}

/* Where the columns of a sample are; those that a log does not have stay at -1. */
typedef struct {
    int time, speed, body[4], wheel[4];
} columns;

static columns find_columns(char *header)
{
    columns found = { -1, -1, { -1, -1, -1, -1 }, { -1, -1, -1, -1 } };
    int column = 0;
    for (char *name = strtok(header, ",\r\n"); name != NULL; name = strtok(NULL, ",\r\n"), column++) {
        if (strcmp(name, "time_s") == 0) {
            found.time = column;
        } else if (strcmp(name, "speed_m_s") == 0) {
            found.speed = column;
        }
        for (int corner = 0; corner < 4; corner++) {
            if (strncmp(name, labels[corner], 2) == 0) {
                if (strcmp(name + 2, "_body_accel_m_s2") == 0) {
                    found.body[corner] = column;
                } else if (strcmp(name + 2, "_wheel_accel_m_s2") == 0) {
                    found.wheel[corner] = column;
                }
            }
        }
    }
    return found;
}

/* The numbers of a line; an empty cell is a missing value. */
static void read_cells(const char *line, double *cells)
{
    for (int column = 0; column < MOST_COLUMNS; column++) {
        cells[column] = NAN;
    }
    for (int column = 0; column < MOST_COLUMNS; column++) {
        char *end;
        double value = strtod(line, &end);
        if (end != line) {
            cells[column] = value;
        }
        line = strchr(end, ',');
        if (line == NULL) {
            return;
        }
        line++;
    }
}

static double cell(const double *cells, int column)
{
    return column >= 0 && column < MOST_COLUMNS ? cells[column] : NAN;
}

static int read_sample(FILE *log, const columns *at, itpms_sample *sample)
{
    static char line[LONGEST_LINE];
    double cells[MOST_COLUMNS];
    if (fgets(line, sizeof line, log) == NULL) {
        return 0;
    }
    read_cells(line, cells);
    sample->time_s = cell(cells, at->time);
    sample->speed_m_s = (itpms_real)cell(cells, at->speed);
    for (int corner = 0; corner < 4; corner++) {
        sample->body_accel_m_s2[corner] = (itpms_real)cell(cells, at->body[corner]);
        sample->wheel_accel_m_s2[corner] = (itpms_real)cell(cells, at->wheel[corner]);
    }
    return 1;
}

static void print_estimate(const itpms_estimate *estimate)
{
    (void)printf("%.9g", estimate->time_s);
    for (int corner = 0; corner < 4; corner++) {
        const itpms_wheel *wheel = &estimate->wheels[corner];
        (void)printf(",%.17g,%.17g,%s", (double)wheel->pressure_kpa, (double)wheel->pressure_sd_kpa, states[wheel->state]);
    }
    (void)printf("\n");
}

/* The active alerts, whenever one began or ended. */
static void print_alerts(itpms_car *car)
{
    static itpms_event events[54];
    static char text[256];
    size_t count = 0;
    if (itpms_car_events(car, events, 54, &count) != ITPMS_STATUS_OK || count == 0) {
        return;
    }
    for (size_t i = 0; itpms_car_alert_text(car, i, text, sizeof text, NULL) == ITPMS_STATUS_OK; i++) {
        (void)fprintf(stderr, "%s\n", text);
    }
}

static double rate_hz(FILE *log, const columns *at)
{
    double first_s = 0.0, last_s = 0.0;
    int rows = 0;
    itpms_sample sample;
    for (; rows < 500 && read_sample(log, at, &sample); rows++) {
        first_s = rows == 0 ? sample.time_s : first_s;
        last_s = sample.time_s;
    }
    return rows > 1 ? (rows - 1) / (last_s - first_s) : 0.0;
}

static int drive(FILE *log, const columns *at, itpms_car *car)
{
    itpms_sample sample;
    itpms_estimate estimate;
    double next_s = -1e300;
    while (read_sample(log, at, &sample)) {
        itpms_status status = itpms_car_update(car, &sample, NULL);
        if (status != ITPMS_STATUS_OK) {
            return failed("a sample", status);
        }
        print_alerts(car);
        if (sample.time_s >= next_s && itpms_car_estimate(car, &estimate) == ITPMS_STATUS_OK) {
            print_estimate(&estimate);
            next_s = sample.time_s + 0.1 - 1e-9;
        }
    }
    return EXIT_SUCCESS;
}

static int run(FILE *log, itpms_config *config, double calibrate_s)
{
    static char header[LONGEST_LINE];
    itpms_problem problem;
    itpms_car *car = NULL;
    columns at;
    long after_header;
    itpms_status status;
    if (fgets(header, sizeof header, log) == NULL) {
        (void)fprintf(stderr, "the log is empty\n");
        return EXIT_FAILURE;
    }
    at = find_columns(header);
    after_header = ftell(log);
    config->sample_rate_hz = rate_hz(log, &at);
    (void)fseek(log, after_header, SEEK_SET);
    status = itpms_car_init(memory, sizeof memory, config, &car, &problem);
    if (status != ITPMS_STATUS_OK) {
        (void)fprintf(stderr, "%s is %g, expected %s\n", problem.parameter, problem.value, problem.expected);
        return failed("the car", status);
    }
    if (calibrate_s > 0.0) {
        status = itpms_car_begin_calibration(car, calibrate_s);
        if (status != ITPMS_STATUS_OK) {
            return failed("the calibration", status);
        }
    }
    (void)printf("time_s");
    for (int corner = 0; corner < 4; corner++) {
        (void)printf(",%s_pressure_kpa,%s_pressure_sd_kpa,%s_state", labels[corner], labels[corner], labels[corner]);
    }
    (void)printf("\n");
    return drive(log, &at, car);
}

int main(int argc, char **argv)
{
    itpms_config config;
    FILE *log;
    int result;
    if (argc < 3) {
        (void)fprintf(stderr, "usage: pressures LOG.csv CAR.toml [CALIBRATE_S]\n");
        return EXIT_FAILURE;
    }
    (void)itpms_config_init(&config, sizeof config);
    result = vehicle_file_read(argv[2], &config);
    log = fopen(argv[1], "r");
    if (result != 0 || log == NULL) {
        (void)fprintf(stderr, "%s or %s cannot be read\n", argv[1], argv[2]);
        return EXIT_FAILURE;
    }
    result = run(log, &config, argc > 3 ? strtod(argv[3], NULL) : 0.0);
    (void)fclose(log);
    return result;
}
