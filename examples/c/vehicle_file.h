/* The keys of a vehicle file (docs/vehicle.md) that a car needs. */
#ifndef VEHICLE_FILE_H
#define VEHICLE_FILE_H

#include "itpms.h"

/* Reads a vehicle file into a configuration that itpms_config_init has filled. Returns 0, or the number of the line that cannot be
 * read; -1: the file cannot be opened. */
int vehicle_file_read(const char *path, itpms_config *config);

#endif
