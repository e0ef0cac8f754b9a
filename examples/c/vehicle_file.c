/* The lines `[section]` and `key = value` of a vehicle file; keys that are not in the tables are passed over. */
#include "vehicle_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const char *key;
    size_t offset;
} place;

#define OF(type, member) { #member, offsetof(type, member) }

static const place of_corner[] = {
    OF(itpms_corner_config, sprung_mass_kg),
    OF(itpms_corner_config, unsprung_mass_kg),
    OF(itpms_corner_config, damping_n_s_per_m),
    OF(itpms_corner_config, spring_n_per_m),
    OF(itpms_corner_config, placard_kpa),
    OF(itpms_corner_config, accel_noise_m_s2),
    OF(itpms_corner_config, initial_kpa),
    OF(itpms_corner_config, sprung_mass_relative_sd),
    OF(itpms_corner_config, unsprung_mass_relative_sd),
    OF(itpms_corner_config, spring_relative_sd),
    OF(itpms_corner_config, damping_relative_sd),
    OF(itpms_corner_config, friction_n),
    OF(itpms_corner_config, friction_sd_n),
    OF(itpms_corner_config, tire_damping_n_s_per_m),
    OF(itpms_corner_config, tire_damping_sd_n_s_per_m),
    { NULL, 0 }
};

static const place of_tire[] = {
    OF(itpms_corner_config, stiffness_per_kpa),
    OF(itpms_corner_config, stiffness_at_zero),
    OF(itpms_corner_config, stiffness_per_kpa_sd),
    OF(itpms_corner_config, stiffness_at_zero_sd),
    OF(itpms_corner_config, stiffness_correlation),
    OF(itpms_corner_config, stiffness_relative_sd),
    OF(itpms_corner_config, stiffness_over_mass_relative_sd),
    { NULL, 0 }
};

static const place of_wheel_speeds[] = {
    OF(itpms_wheel_speed_config, track_front_m),
    OF(itpms_wheel_speed_config, track_rear_m),
    { NULL, 0 }
};

/* Puts a number where the table says that its key belongs. */
static int put(void *into, const place *places, const char *key, const char *value)
{
    for (; places->key != NULL; places++) {
        if (strcmp(places->key, key) == 0) {
            char *end = NULL;
            itpms_real number = (itpms_real)strtod(value, &end);
            memcpy((char *)into + places->offset, &number, sizeof number);
            return end != value;
        }
    }
    return 1;
}

/* `fl`, `fr`, `rl` or `rr`; 4: none of them. */
static int corner_of(const char *label)
{
    static const char *const labels[] = { "fl", "fr", "rl", "rr" };
    int corner = 0;
    while (corner < 4 && strncmp(labels[corner], label, 2) != 0) {
        corner++;
    }
    return corner;
}

static int put_vehicle(itpms_config *config, const char *key, const char *value)
{
    if (strcmp(key, "wheelbase_m") == 0) {
        config->wheelbase_m = (itpms_real)strtod(value, NULL);
    } else if (strcmp(key, "confidence") == 0) {
        config->confidence = strcmp(value, "\"measured\"") == 0 ? ITPMS_CONFIDENCE_MEASURED
                             : strcmp(value, "\"rough\"") == 0 ? ITPMS_CONFIDENCE_ROUGH
                                                               : ITPMS_CONFIDENCE_TYPICAL;
    } else if (strcmp(key, "driven") == 0) {
        config->wheel_speeds.driven = strcmp(value, "\"rear\"") == 0 ? ITPMS_DRIVEN_REAR
                                      : strcmp(value, "\"all\"") == 0 ? ITPMS_DRIVEN_ALL
                                                                      : ITPMS_DRIVEN_FRONT;
    }
    return put(&config->wheel_speeds, of_wheel_speeds, key, value);
}

/* A line `key = value` of a section. */
static int put_line(itpms_config *config, const char *section, const char *key, const char *value)
{
    int corner = strncmp(section, "corner.", 7) == 0 ? corner_of(section + 7) : 4;
    if (strcmp(section, "vehicle") == 0) {
        return put_vehicle(config, key, value);
    }
    if (strcmp(section, "tire") == 0) {
        int good = 1;
        for (corner = 0; corner < 4; corner++) {
            good = good && put(&config->corners[corner], of_tire, key, value);
        }
        return good;
    }
    if (corner == 4) {
        return 1;
    }
    config->corners[corner].is_measured = 1;
    return put(&config->corners[corner], strcmp(section + 9, ".tire") == 0 ? of_tire : of_corner, key, value);
}

int vehicle_file_read(const char *path, itpms_config *config)
{
    char line[256], section[64] = "", key[64], value[128];
    int number = 0, bad = 0;
    FILE *file = fopen(path, "r");
    if (file == NULL) {
        return -1;
    }
    while (bad == 0 && fgets(line, sizeof line, file) != NULL) {
        number++;
        if (sscanf(line, " [%63[^]]", section) == 1) {
            continue;
        }
        if (sscanf(line, " %63[a-z_0-9] = %127[^#\r\n]", key, value) == 2) {
            value[strcspn(value, " \t")] = '\0';
            bad = put_line(config, section, key, value) ? 0 : number;
        }
    }
    (void)fclose(file);
    return bad;
}
