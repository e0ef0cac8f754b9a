/* Sizes of the header's structs and places of their last members, as the C compiler has them. Ends with 3 where the library is of the
 * other precision. */
#include <stdio.h>

#include "itpms.h"

#define SIZE(type, last) (void)printf(#type " %zu %zu\n", sizeof(type), offsetof(type, last))

int main(void)
{
    itpms_config config;
    if (itpms_config_init(&config, sizeof config) == ITPMS_STATUS_WRONG_SIZE) {
        return 3;
    }
    SIZE(itpms_corner_config, tire_damping_sd_n_s_per_m);
    SIZE(itpms_wheel_speed_config, load_front_passengers_sd);
    SIZE(itpms_config, home_altitude_m);
    SIZE(itpms_air, altitude_m);
    SIZE(itpms_cold_wheel, add_kpa);
    SIZE(itpms_cold_report, wheels);
    SIZE(itpms_sample, wheel_accel_m_s2);
    SIZE(itpms_wheel_speed_sample, brake);
    SIZE(itpms_wheel, radius_lost_share_sd);
    SIZE(itpms_estimate, low_wheels);
    SIZE(itpms_wheel_radius, lost_share_sd);
    SIZE(itpms_radius_report, loads_may_differ);
    SIZE(itpms_alert, probability);
    SIZE(itpms_event, alert);
    SIZE(itpms_problem, expected);
    return 0;
}
