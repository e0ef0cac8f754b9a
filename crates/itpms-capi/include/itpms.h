/* Indirect tire pressure monitoring: the C interface of itpms. MIT or Apache-2.0.
 *
 * Made by cbindgen from crates/itpms-capi; docs/c-library.md tells how it is used. Define ITPMS_F64 for the library in double precision.
 * A car belongs to one thread at a time; different cars have nothing in common. */

#ifndef ITPMS_H
#define ITPMS_H

#include <stddef.h>
#include <stdint.h>

/*
 Version of this interface, for `itpms_config`.
 */
#define ITPMS_API_VERSION 1

#if !defined(ITPMS_F64)
/*
 Bytes that a car takes at most, for memory that is there when the program starts; `itpms_car_size` is exact.
 */
#define ITPMS_CAR_MAX_SIZE 262144
#endif

#if defined(ITPMS_F64)
/*
 Bytes that a car takes at most.
 */
#define ITPMS_CAR_MAX_SIZE 524288
#endif

#if !defined(ITPMS_F64)
/*
 Bytes that wheel speeds alone take at most; `itpms_wheels_size` is exact.
 */
#define ITPMS_WHEELS_MAX_SIZE 5120
#endif

#if defined(ITPMS_F64)
/*
 Bytes that wheel speeds alone take at most.
 */
#define ITPMS_WHEELS_MAX_SIZE 10240
#endif

/*
 Bytes that a stored calibration takes at most.
 */
#define ITPMS_CALIBRATION_MAX_SIZE 1024

/*
 What became of a call. Everything but `ITPMS_STATUS_OK` leaves all as it was, unless the function says otherwise.
 */
enum itpms_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /*
   Done.
   */
  ITPMS_STATUS_OK = 0,
  /*
   A pointer that may not be null is null.
   */
  ITPMS_STATUS_NULL_POINTER = 1,
  /*
   A pointer is not aligned for what it points to.
   */
  ITPMS_STATUS_MISALIGNED = 2,
  /*
   `struct_size` is not that of this library: header and library differ in version or precision.
   */
  ITPMS_STATUS_WRONG_SIZE = 3,
  /*
   `api_version` is not `ITPMS_API_VERSION` of this library.
   */
  ITPMS_STATUS_WRONG_VERSION = 4,
  /*
   The memory that was given is too small for what belongs there.
   */
  ITPMS_STATUS_TOO_SMALL = 5,
  /*
   The memory holds no car, or no wheel speeds where these are asked for: its init was not called, or failed.
   */
  ITPMS_STATUS_NOT_A_CAR = 6,
  /*
   A parameter is outside its range or no number; `itpms_problem` names it.
   */
  ITPMS_STATUS_BAD_PARAMETER = 7,
  /*
   A choice has none of its values.
   */
  ITPMS_STATUS_BAD_CHOICE = 8,
  /*
   The time of a sample is not finite.
   */
  ITPMS_STATUS_BAD_TIME = 9,
  /*
   There is nothing of that index.
   */
  ITPMS_STATUS_BAD_INDEX = 10,
  /*
   A length of time is not positive and finite.
   */
  ITPMS_STATUS_BAD_DURATION = 11,
  /*
   Nothing was learned: no calibration is over, or it saw too little.
   */
  ITPMS_STATUS_NOT_CALIBRATED = 12,
  /*
   The car was configured without wheel speeds.
   */
  ITPMS_STATUS_NO_WHEEL_SPEEDS = 13,
  /*
   The car was configured without corners.
   */
  ITPMS_STATUS_NO_CORNERS = 14,
  /*
   The bytes are not what was saved: their checksum does not hold.
   */
  ITPMS_STATUS_DAMAGED = 15,
  /*
   The bytes were saved by another version of the library, or hold something else.
   */
  ITPMS_STATUS_OTHER_FORMAT = 16,
  /*
   The calibration was learned for other corners or other placard pressures.
   */
  ITPMS_STATUS_OTHER_CAR = 17,
  /*
   The calibration holds what no car could have.
   */
  ITPMS_STATUS_IMPLAUSIBLE = 18,
  /*
   A sample was taken already: a stored calibration comes before the first one.
   */
  ITPMS_STATUS_TOO_LATE = 19,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum itpms_status itpms_status;
#else
typedef uint32_t itpms_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 What a pressure was held against.
 */
enum itpms_basis
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /*
   Against its level as the configuration has it.
   */
  ITPMS_BASIS_CONFIG = 0,
  /*
   Against what a calibration has set.
   */
  ITPMS_BASIS_CALIBRATION = 1,
  /*
   Against the other tires.
   */
  ITPMS_BASIS_OTHER_TIRES = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum itpms_basis itpms_basis;
#else
typedef uint32_t itpms_basis;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 Whether the driver brakes.
 */
enum itpms_brake
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /*
   The bus does not say.
   */
  ITPMS_BRAKE_UNKNOWN = 0,
  /*
   The brakes are not applied.
   */
  ITPMS_BRAKE_OFF = 1,
  /*
   The brakes are applied.
   */
  ITPMS_BRAKE_ON = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum itpms_brake itpms_brake;
#else
typedef uint32_t itpms_brake;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 Why an alert stands.
 */
enum itpms_cause
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /*
   The pressure is certainly below the limit.
   */
  ITPMS_CAUSE_UNDER_INFLATED = 0,
  /*
   The pressure falls fast against that of the other wheels.
   */
  ITPMS_CAUSE_FAST_LEAK = 1,
  /*
   All wheels together are low.
   */
  ITPMS_CAUSE_ALL_LOW = 2,
  /*
   All wheels together read otherwise than a calibration of an earlier day.
   */
  ITPMS_CAUSE_COMMON_SHIFT = 3,
  /*
   The pressure is certainly above the limit.
   */
  ITPMS_CAUSE_OVER_INFLATED = 4,
  /*
   Flat, on its rim.
   */
  ITPMS_CAUSE_FLAT = 5,
  /*
   A sensor or its wiring.
   */
  ITPMS_CAUSE_MALFUNCTION = 6,
  /*
   By the wheel speeds: it rolls on a smaller radius than the others since the calibration.
   */
  ITPMS_CAUSE_DIFFERS = 7,
  /*
   Nothing could be learned for too long a time of driving.
   */
  ITPMS_CAUSE_NO_INFORMATION = 8,
  /*
   By the wheel speeds of several days: it has lost air slowly since the calibration.
   */
  ITPMS_CAUSE_SLOW_LEAK = 9,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum itpms_cause itpms_cause;
#else
typedef uint32_t itpms_cause;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 Whether a cold tire would have the air that it should have.
 */
enum itpms_cold_state
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /*
   Its pressure is not valid, or the temperature of the air is not known.
   */
  ITPMS_COLD_STATE_UNKNOWN = 0,
  /*
   It lacks no more than its standard deviation, or less than 5 kPa.
   */
  ITPMS_COLD_STATE_FINE = 1,
  /*
   It lacks `add_kpa`.
   */
  ITPMS_COLD_STATE_ADD = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum itpms_cold_state itpms_cold_state;
#else
typedef uint32_t itpms_cold_state;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 How far the parameters of a car are to be trusted: standard deviations of parameters without one of their own.
 */
enum itpms_confidence
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /*
   Weighed and measured on this car.
   */
  ITPMS_CONFIDENCE_MEASURED = 0,
  /*
   A manufacturer's figures, or a car of the same model that was measured.
   */
  ITPMS_CONFIDENCE_TYPICAL = 1,
  /*
   A guess.
   */
  ITPMS_CONFIDENCE_ROUGH = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum itpms_confidence itpms_confidence;
#else
typedef uint32_t itpms_confidence;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 Why a wheel's state is unknown.
 */
enum itpms_doubt
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /*
   It is known.
   */
  ITPMS_DOUBT_NONE = 0,
  /*
   Not enough has been seen since the start, or since a malfunction ended.
   */
  ITPMS_DOUBT_STARTING = 1,
  /*
   Nothing to learn from, or learned too long ago.
   */
  ITPMS_DOUBT_NO_INFORMATION = 2,
  /*
   There is a pressure, but it could be low as well as not.
   */
  ITPMS_DOUBT_UNCERTAIN = 3,
  /*
   A sensor looks wrong; not for long enough to say so.
   */
  ITPMS_DOUBT_SUSPICION = 4,
  /*
   The car does not move as its configuration says.
   */
  ITPMS_DOUBT_MISFIT = 5,
  /*
   The car stands.
   */
  ITPMS_DOUBT_STANDING = 6,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum itpms_doubt itpms_doubt;
#else
typedef uint32_t itpms_doubt;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 Which wheels the engine turns.
 */
enum itpms_driven
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /*
   The front wheels.
   */
  ITPMS_DRIVEN_FRONT = 0,
  /*
   The rear wheels.
   */
  ITPMS_DRIVEN_REAR = 1,
  /*
   All four.
   */
  ITPMS_DRIVEN_ALL = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum itpms_driven itpms_driven;
#else
typedef uint32_t itpms_driven;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 What the level of a pressure rests on; changes show by themselves.
 */
enum itpms_level
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /*
   On masses and the tire's stiffness in the configuration.
   */
  ITPMS_LEVEL_CONFIG = 0,
  /*
   On a calibration of this drive.
   */
  ITPMS_LEVEL_CALIBRATION = 1,
  /*
   On a calibration that was loaded.
   */
  ITPMS_LEVEL_STORED_CALIBRATION = 2,
  /*
   On nothing: what is known is how the tire differs from the others since a calibration.
   */
  ITPMS_LEVEL_OTHER_TIRES = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum itpms_level itpms_level;
#else
typedef uint32_t itpms_level;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 What is wrong with sensors.
 */
enum itpms_malfunction
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /*
   Nothing: the alert is about a tire.
   */
  ITPMS_MALFUNCTION_NONE = 0,
  /*
   It repeats one value.
   */
  ITPMS_MALFUNCTION_STUCK = 1,
  /*
   Too many of its samples are missing.
   */
  ITPMS_MALFUNCTION_DROPOUT = 2,
  /*
   Single samples far from their neighbors.
   */
  ITPMS_MALFUNCTION_SPIKES = 3,
  /*
   Noisier than the same sensors at the other corners.
   */
  ITPMS_MALFUNCTION_NOISE = 4,
  /*
   It reads too much or too little: `gain` times the truth.
   */
  ITPMS_MALFUNCTION_GAIN = 5,
  /*
   Two sensors carry each other's name.
   */
  ITPMS_MALFUNCTION_SWAPPED = 6,
  /*
   Left and right of one axle carry each other's name; of which is unknown.
   */
  ITPMS_MALFUNCTION_SWAPPED_SIDES = 7,
  /*
   Front and rear of one side carry each other's name; of which is unknown.
   */
  ITPMS_MALFUNCTION_SWAPPED_AXLES = 8,
  /*
   The corner's signals do not fit each other or the rest of the car.
   */
  ITPMS_MALFUNCTION_INCONSISTENT = 9,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum itpms_malfunction itpms_malfunction;
#else
typedef uint32_t itpms_malfunction;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 What wheel speeds say of the car.
 */
enum itpms_radius_state
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /*
   No wheel speeds are used, or no calibration has taught how the tires differ.
   */
  ITPMS_RADIUS_STATE_UNCALIBRATED = 0,
  /*
   A calibration goes on.
   */
  ITPMS_RADIUS_STATE_CALIBRATING = 1,
  /*
   A loss of 30 % of any single tire would not show.
   */
  ITPMS_RADIUS_STATE_UNINFORMED = 2,
  /*
   No tire differs from the others.
   */
  ITPMS_RADIUS_STATE_NONE_DIFFERS = 3,
  /*
   The tires of `low_wheels` are low.
   */
  ITPMS_RADIUS_STATE_LOW = 4,
  /*
   One of them is, or all of them; which, is not known.
   */
  ITPMS_RADIUS_STATE_ONE_OF = 5,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum itpms_radius_state itpms_radius_state;
#else
typedef uint32_t itpms_radius_state;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 Which loss is warned of.
 */
enum itpms_regulation
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /*
   UN R141 (5.3): 20 % below the warm reference.
   */
  ITPMS_REGULATION_UN_R141 = 0,
  /*
   FMVSS 138 (S4.2): 25 % below the placard.
   */
  ITPMS_REGULATION_FMVSS138 = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum itpms_regulation itpms_regulation;
#else
typedef uint32_t itpms_regulation;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 What is known of a wheel in one word. Unknown is never to be shown as "all good".
 */
enum itpms_state
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /*
   Unknown; `itpms_doubt` says why.
   */
  ITPMS_STATE_UNKNOWN = 0,
  /*
   Known to be neither low nor overfull.
   */
  ITPMS_STATE_FINE = 1,
  /*
   Under-inflated, leaking fast, falling with all the others, or flat on its rim.
   */
  ITPMS_STATE_LOW = 2,
  /*
   Over-inflated.
   */
  ITPMS_STATE_OVER = 3,
  /*
   A sensor of this corner is not to be trusted.
   */
  ITPMS_STATE_MALFUNCTION = 4,
  /*
   There is a pressure, but it could be low as well as not.
   */
  ITPMS_STATE_UNCERTAIN = 5,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum itpms_state itpms_state;
#else
typedef uint32_t itpms_state;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 Whether, and if not why not, a pressure may be believed.
 */
enum itpms_validity
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /*
   Not enough has been seen since the start.
   */
  ITPMS_VALIDITY_STARTING = 0,
  /*
   The data says this.
   */
  ITPMS_VALIDITY_VALID = 1,
  /*
   Nothing to learn from for a while: standing still, too smooth, hidden in noise.
   */
  ITPMS_VALIDITY_NO_INFORMATION = 2,
  /*
   Samples are missing, stuck or absurd.
   */
  ITPMS_VALIDITY_BAD_SIGNAL = 3,
  /*
   The computation left its range.
   */
  ITPMS_VALIDITY_DIVERGED = 4,
  /*
   Body and wheel do not move as the configuration says.
   */
  ITPMS_VALIDITY_MISFIT = 5,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum itpms_validity itpms_validity;
#else
typedef uint32_t itpms_validity;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 What the driver should know about one tire.
 */
enum itpms_warning
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /*
   Nothing to say. No promise that all is well: see `itpms_state`.
   */
  ITPMS_WARNING_NONE = 0,
  /*
   Under-inflated.
   */
  ITPMS_WARNING_LOW = 1,
  /*
   The sensors do not allow a statement.
   */
  ITPMS_WARNING_MALFUNCTION = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum itpms_warning itpms_warning;
#else
typedef uint32_t itpms_warning;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 A car, in memory of the caller. What is in it is the library's own.
 */
typedef struct itpms_car itpms_car;

/*
 Four wheel speeds without a car around them, in memory of the caller. What is in it is the library's own.
 */
typedef struct itpms_wheels itpms_wheels;

#if !defined(ITPMS_F64)
/*
 The scalar of the library: `float`, or `double` with `ITPMS_F64`, as the library was built.
 */
typedef float itpms_real;
#endif

#if defined(ITPMS_F64)
/*
 The scalar of the library.
 */
typedef double itpms_real;
#endif

/*
 One corner of the car: masses, spring, damper, tire. NaN stands for what follows "NaN:".
 */
typedef struct {
  /*
   1: this corner has both accelerometers; 0: it is left out, and nothing else here is read.
   */
  uint32_t is_measured;
  /*
   Sprung mass in kg.
   */
  itpms_real sprung_mass_kg;
  /*
   Unsprung mass in kg.
   */
  itpms_real unsprung_mass_kg;
  /*
   Damping at the wheel in N s/m.
   */
  itpms_real damping_n_s_per_m;
  /*
   Spring rate at the wheel in N/m.
   */
  itpms_real spring_n_per_m;
  /*
   Tire stiffness over gauge pressure in N/m per kPa.
   */
  itpms_real stiffness_per_kpa;
  /*
   Tire stiffness at no gauge pressure in N/m.
   */
  itpms_real stiffness_at_zero;
  /*
   Standard deviation of `stiffness_per_kpa` in N/m per kPa; NaN: 0.
   */
  itpms_real stiffness_per_kpa_sd;
  /*
   Standard deviation of `stiffness_at_zero` in N/m; NaN: 0.
   */
  itpms_real stiffness_at_zero_sd;
  /*
   Correlation of the two, -1 to 1; NaN: 0.
   */
  itpms_real stiffness_correlation;
  /*
   Gauge pressure on the placard in kPa.
   */
  itpms_real placard_kpa;
  /*
   What the warm tire should have in kPa gauge; NaN: the placard's.
   */
  itpms_real reference_kpa;
  /*
   Gauge pressure to start from in kPa; NaN: the placard's.
   */
  itpms_real initial_kpa;
  /*
   Noise of both accelerometers in m/s^2, rms per sample; NaN: 0.05.
   */
  itpms_real accel_noise_m_s2;
  /*
   Relative standard deviation of the sprung mass (0.05 is 5 %); NaN: by `confidence`.
   */
  itpms_real sprung_mass_relative_sd;
  /*
   The same of the unsprung mass.
   */
  itpms_real unsprung_mass_relative_sd;
  /*
   The same of the spring.
   */
  itpms_real spring_relative_sd;
  /*
   The same of the damping.
   */
  itpms_real damping_relative_sd;
  /*
   The same of the tire's line of stiffness over pressure, as one scale.
   */
  itpms_real stiffness_relative_sd;
  /*
   The same of the tire's stiffness over the unsprung mass; NaN: from the two, each by itself.
   */
  itpms_real stiffness_over_mass_relative_sd;
  /*
   Coulomb friction of the strut in N; NaN: by `confidence`.
   */
  itpms_real friction_n;
  /*
   Its standard deviation in N; NaN: by `confidence`.
   */
  itpms_real friction_sd_n;
  /*
   Vertical damping of the tire in N s/m; NaN: by `confidence`.
   */
  itpms_real tire_damping_n_s_per_m;
  /*
   Its standard deviation in N s/m; NaN: by `confidence`.
   */
  itpms_real tire_damping_sd_n_s_per_m;
} itpms_corner_config;

/*
 Radius analysis of four wheel speeds, beside the accelerations or alone.
 */
typedef struct {
  /*
   1: wheel speeds are used; 0: they are not, and nothing else here is read.
   */
  uint32_t is_used;
  /*
   Which wheels the engine turns: an `itpms_driven`.
   */
  uint32_t driven;
  /*
   1: the wheels of a driven axle are coupled, so that they turn alike under torque.
   */
  uint32_t has_limited_slip;
  /*
   Distance between the front wheels in m.
   */
  itpms_real track_front_m;
  /*
   Distance between the rear wheels in m.
   */
  itpms_real track_rear_m;
  /*
   `d ln R / d ln p` of the rolling radius R; NaN: 0.007.
   */
  itpms_real radius_per_ln_pressure;
  /*
   Its standard deviation as a share of it; NaN: 0.6.
   */
  itpms_real radius_per_ln_pressure_sd;
  /*
   Standard deviation of the rear axle's load from drive to drive, as a share of it; NaN: 0.2.
   */
  itpms_real load_rear_axle_sd;
  /*
   The same of one rear wheel's load against the other's; NaN: 0.03.
   */
  itpms_real load_rear_left_right_sd;
  /*
   Front passengers who get in or out, as a standard deviation; NaN: 1.
   */
  itpms_real load_front_passengers_sd;
} itpms_wheel_speed_config;

/*
 All that a car is given. Filled with its defaults by `itpms_config_init`; four-element arrays are front left, front right,
 rear left, rear right.
 */
typedef struct {
  /*
   `sizeof (itpms_config)`.
   */
  uint32_t struct_size;
  /*
   `ITPMS_API_VERSION`.
   */
  uint32_t api_version;
  /*
   Samples per second, about: 100 to 2000. The samples' own times count.
   */
  double sample_rate_hz;
  /*
   Distance between the axles in m; NaN: the road that front and rear share is not used.
   */
  itpms_real wheelbase_m;
  /*
   How far the parameters are to be trusted: an `itpms_confidence`.
   */
  uint32_t confidence;
  /*
   Which loss is warned of: an `itpms_regulation`.
   */
  uint32_t regulation;
  /*
   Loss to be warned of as a share of the warm reference, up to 0.5; NaN: by `regulation`.
   */
  itpms_real loss_share;
  /*
   1: the height of the road under each wheel is estimated with every sample, which costs time.
   */
  uint32_t wants_road;
  /*
   1: tires may gain air while they roll, as of a car with pumps.
   */
  uint32_t has_pumps;
  /*
   The corners.
   */
  itpms_corner_config corners[4];
  /*
   Wheel speeds.
   */
  itpms_wheel_speed_config wheel_speeds;
  /*
   Height above the sea in m where the tires are filled, -500 to 6000; NaN: 0.
   */
  itpms_real home_altitude_m;
} itpms_config;

/*
 What is wrong with a configuration.
 */
typedef struct {
  /*
   What was given.
   */
  double value;
  /*
   The corner it is about: 0 front left, 1 front right, 2 rear left, 3 rear right; 4: none.
   */
  uint32_t corner;
  /*
   The parameter's name, ended by a zero; empty where it is about none.
   */
  char parameter[48];
  /*
   What would be accepted, ended by a zero.
   */
  char expected[48];
} itpms_problem;

/*
 One sample of the accelerometers. NaN: the value is missing.
 */
typedef struct {
  /*
   Time in s, increasing, of any origin.
   */
  double time_s;
  /*
   Speed of the car in m/s; NaN: not known.
   */
  itpms_real speed_m_s;
  /*
   Vertical accelerations of the body over the wheels in m/s^2, positive upward, with or without gravity: front left, front right,
   rear left, rear right.
   */
  itpms_real body_accel_m_s2[4];
  /*
   The same of the wheels.
   */
  itpms_real wheel_accel_m_s2[4];
} itpms_sample;

/*
 One wheel. NaN: not known.
 */
typedef struct {
  /*
   1 if the car was configured with this corner, or with wheel speeds alone; else the rest says nothing.
   */
  uint32_t is_monitored;
  /*
   An `itpms_validity`: whether the pressure may be shown.
   */
  uint32_t validity;
  /*
   An `itpms_state`.
   */
  uint32_t state;
  /*
   An `itpms_doubt`.
   */
  uint32_t doubt;
  /*
   An `itpms_warning`.
   */
  uint32_t warning;
  /*
   An `itpms_level`.
   */
  uint32_t level;
  /*
   Gauge pressure in kPa.
   */
  itpms_real pressure_kpa;
  /*
   Its standard deviation in kPa, with what the configuration leaves open.
   */
  itpms_real pressure_sd_kpa;
  /*
   Standard deviation in kPa of a change within minutes.
   */
  itpms_real change_sd_kpa;
  /*
   Standard deviation in kPa of its difference from the axle's other tire.
   */
  itpms_real axle_difference_sd_kpa;
  /*
   What the tire has lost in this drive in kPa; NaN as long as that is not counted, and where it was low before that.
   */
  itpms_real lost_kpa;
  /*
   Its standard deviation in kPa.
   */
  itpms_real lost_sd_kpa;
  /*
   Tire stiffness in N/m.
   */
  itpms_real stiffness_n_per_m;
  /*
   Its standard deviation in N/m.
   */
  itpms_real stiffness_sd_n_per_m;
  /*
   What the pressure is held against, in kPa.
   */
  itpms_real reference_kpa;
  /*
   Height of the road under the wheel in m, causal and without drift; only with `wants_road`.
   */
  itpms_real road_m;
  /*
   Its standard deviation in m.
   */
  itpms_real road_sd_m;
  /*
   By wheel speeds: share of its pressure that the tire has lost since the calibration.
   */
  itpms_real radius_lost_share;
  /*
   Its standard deviation.
   */
  itpms_real radius_lost_share_sd;
} itpms_wheel;

/*
 What is known of the car after a sample.
 */
typedef struct {
  /*
   Time in s of the last sample; NaN before the first one.
   */
  double time_s;
  /*
   Front left, front right, rear left, rear right.
   */
  itpms_wheel wheels[4];
  /*
   Correlation coefficients of the pressures' errors.
   */
  itpms_real correlation[4][4];
  /*
   1 where front and rear of the left and of the right side are found to meet the same road.
   */
  uint32_t shares_road[2];
  /*
   An `itpms_radius_state`: what wheel speeds say.
   */
  uint32_t radius_state;
  /*
   Wheels that differ from the others by the wheel speeds: bit 0 front left, 1 front right, 2 rear left, 3 rear right.
   */
  uint32_t low_wheels;
} itpms_estimate;

/*
 Four wheel speeds and how the car moves, at 10 Hz or more. NaN: not known.
 */
typedef struct {
  /*
   Time in s, increasing, by the same clock as the accelerometers' samples.
   */
  double time_s;
  /*
   Speeds of the wheels in m/s, each by the same assumed radius: front left, front right, rear left, rear right.
   */
  itpms_real wheel_speed_m_s[4];
  /*
   Yaw rate in rad/s, positive to the left.
   */
  itpms_real yaw_rate_rad_s;
  /*
   Acceleration forward in m/s^2.
   */
  itpms_real accel_x_m_s2;
  /*
   Acceleration to the left in m/s^2.
   */
  itpms_real accel_y_m_s2;
  /*
   An `itpms_brake`.
   */
  uint32_t brake;
} itpms_wheel_speed_sample;

/*
 The air around the car. NaN: not sent.
 */
typedef struct {
  /*
   Temperature in degrees Celsius.
   */
  itpms_real ambient_temperature_c;
  /*
   Absolute pressure in kPa.
   */
  itpms_real barometric_kpa;
  /*
   Height above the sea in m, used where there is no barometer.
   */
  itpms_real altitude_m;
} itpms_air;

/*
 What a tire would have cold. NaN: not known.
 */
typedef struct {
  /*
   An `itpms_cold_state`.
   */
  uint32_t state;
  /*
   Gauge pressure in kPa at the temperature of the air, where tires are filled.
   */
  itpms_real pressure_kpa;
  /*
   Its standard deviation in kPa.
   */
  itpms_real pressure_sd_kpa;
  /*
   What is to be added in kPa, cold, up to the placard's pressure; NaN: nothing.
   */
  itpms_real add_kpa;
} itpms_cold_wheel;

/*
 What the tires would have cold.
 */
typedef struct {
  /*
   Temperature of the air in degrees Celsius that it was computed with; NaN: not known.
   */
  itpms_real ambient_temperature_c;
  /*
   Front left, front right, rear left, rear right.
   */
  itpms_cold_wheel wheels[4];
} itpms_cold_report;

/*
 Something the driver or the workshop should know. Numbers that its cause does not have are NaN.
 */
typedef struct {
  /*
   Since when it has been so, in s by the samples' clock, as far as is known.
   */
  double since_s;
  /*
   When it was first reported, in s by the same clock.
   */
  double reported_s;
  /*
   Of NO_INFORMATION: the time of driving in s.
   */
  double driven_s;
  /*
   The wheels it is about: bit 0 front left, 1 front right, 2 rear left, 3 rear right.
   */
  uint32_t wheels;
  /*
   An `itpms_cause`.
   */
  uint32_t cause;
  /*
   An `itpms_basis`, of an alert with a pressure.
   */
  uint32_t basis;
  /*
   An `itpms_malfunction`.
   */
  uint32_t malfunction;
  /*
   The sensors with the malfunction: bits 0 to 3 the body's, 4 to 7 the wheels', 8 to 11 the wheel speeds'.
   */
  uint32_t sensors;
  /*
   Of DIFFERS: 1 if all of `wheels` differ; 0 if one of them or more does, and which is not known.
   */
  uint32_t wheels_are_known;
  /*
   The pressure that decided, in kPa gauge.
   */
  itpms_real pressure_kpa;
  /*
   Its standard deviation in kPa.
   */
  itpms_real pressure_sd_kpa;
  /*
   The limit that it has passed, in kPa.
   */
  itpms_real limit_kpa;
  /*
   What it should be, in kPa.
   */
  itpms_real reference_kpa;
  /*
   Of FAST_LEAK: how fast it fell at most, in kPa per minute.
   */
  itpms_real rate_kpa_per_min;
  /*
   Of ALL_LOW and COMMON_SHIFT: mean of pressure over reference. Of DIFFERS and SLOW_LEAK: the share of its pressure that the tire has lost.
   */
  itpms_real share;
  /*
   The standard deviation of `share`.
   */
  itpms_real share_sd;
  /*
   Of GAIN: reading over truth.
   */
  itpms_real gain;
  /*
   How probable it is, of what says that tires have too little air; NaN of FLAT.
   */
  itpms_real probability;
} itpms_alert;

/*
 What began or ended.
 */
typedef struct {
  /*
   1: the alert was raised; 0: it was taken back.
   */
  uint32_t has_begun;
  /*
   The alert, as it stands or stood at the end.
   */
  itpms_alert alert;
} itpms_event;

/*
 One wheel by its speed. NaN: not known.
 */
typedef struct {
  /*
   An `itpms_state`: UNKNOWN, FINE (it does not differ from the others) or LOW.
   */
  uint32_t state;
  /*
   An `itpms_doubt`.
   */
  uint32_t doubt;
  /*
   1 if a loss of 30 % of this tire alone would show.
   */
  uint32_t is_informed;
  /*
   Probability that this tire is low.
   */
  itpms_real low_probability;
  /*
   Change of the rolling radius since the calibration, as a share of it.
   */
  itpms_real radius_change;
  /*
   Its standard deviation.
   */
  itpms_real radius_change_sd;
  /*
   Share of its pressure that the tire has lost since the calibration.
   */
  itpms_real lost_share;
  /*
   Its standard deviation.
   */
  itpms_real lost_share_sd;
  /*
   Smallest loss of this tire alone that would have shown since the calibration, as a share of its pressure.
   */
  itpms_real detectable_loss_share;
} itpms_wheel_radius;

/*
 What four wheel speeds alone say: which tires differ from the others since the calibration. A loss of all four alike is not seen.
 */
typedef struct {
  /*
   Time in s of the last sample; NaN before the first one.
   */
  double time_s;
  /*
   Front left, front right, rear left, rear right.
   */
  itpms_wheel_radius wheels[4];
  /*
   Probability that any tire is low.
   */
  itpms_real any_low_probability;
  /*
   An `itpms_radius_state`.
   */
  uint32_t state;
  /*
   Wheels of the states LOW and ONE_OF: bit 0 front left, 1 front right, 2 rear left, 3 rear right.
   */
  uint32_t low_wheels;
  /*
   Wheels that turn like their neighbor under torque, low or not: the same bits.
   */
  uint32_t hidden_wheels;
  /*
   1 without a yaw rate that can be believed: of a front wheel and the rear wheel across only the pair may be known.
   */
  uint32_t is_diagonal_open;
  /*
   1 if the car stood since the calibration, so that loads may have changed: rear tires, and both of an axle, need a larger loss.
   */
  uint32_t loads_may_differ;
} itpms_radius_report;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 The library's version, as "0.1.0".
 */
const char *itpms_version(void);

/*
 A status as a sentence in English, for any number.
 */
const char *itpms_status_text(uint32_t status);

/*
 Fills a configuration with its defaults: what is not known is NaN, no corner is measured, no wheel speed used.

 `struct_size` is `sizeof *config`. Errors: NULL_POINTER, MISALIGNED, WRONG_SIZE (nothing is written then).

 # Safety
 `config` is null or points to `struct_size` bytes.
 */
itpms_status itpms_config_init(itpms_config *config, size_t struct_size);

/*
 Bytes of memory that a car takes; at most `ITPMS_CAR_MAX_SIZE`.
 */
size_t itpms_car_size(void);

/*
 Alignment in bytes of that memory; at most that of a `double`, or of a pointer where that is more.
 */
size_t itpms_car_align(void);

/*
 Makes a car of `size` bytes of memory, which stays the caller's and may not move while the car is used; `*car` is what the other
 functions take. Takes some 11 KiB of stack in `float`. What was in the memory is forgotten.

 `problem` may be null; else it says what is wrong with the configuration. Errors: NULL_POINTER, MISALIGNED (memory by
 `itpms_car_align`), TOO_SMALL, WRONG_SIZE, WRONG_VERSION, BAD_PARAMETER, BAD_CHOICE; there is no car then.

 # Safety
 Every pointer is null or points to memory of its type, `memory` to `size` bytes that nothing else uses.
 */
itpms_status itpms_car_init(void *memory,
                            size_t size,
                            const itpms_config *config,
                            itpms_car **car,
                            itpms_problem *problem);

/*
 Takes a sample of the accelerometers and writes what is known after it; `estimate` may be null. Values that are NaN are missing.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, NO_CORNERS, BAD_TIME (the sample is left out).

 # Safety
 Every pointer is null or points to what its type says.
 */
itpms_status itpms_car_update(itpms_car *car,
                              const itpms_sample *sample,
                              itpms_estimate *estimate);

/*
 Takes a sample of the wheel speeds.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, NO_WHEEL_SPEEDS, BAD_TIME and BAD_CHOICE (the sample is left out).

 # Safety
 Every pointer is null or points to what its type says.
 */
itpms_status itpms_car_update_wheel_speeds(itpms_car *car, const itpms_wheel_speed_sample *sample);

/*
 Takes the air around the car, as often as it is measured, before the sample of that time: its last values hold for half an hour.
 Impossible ones count as missing. Where the temperature is known there are cold pressures, and warnings go by them
 (docs/cold-pressure.md).

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, NO_CORNERS.

 # Safety
 Every pointer is null or points to what its type says.
 */
itpms_status itpms_car_update_air(itpms_car *car,
                                  const itpms_air *air);

/*
 Writes what the tires would have cold, after the last sample.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR.

 # Safety
 Every pointer is null or points to what its type says.
 */
itpms_status itpms_car_cold(itpms_car *car, itpms_cold_report *report);

/*
 Writes what is known after the last sample.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR.

 # Safety
 Every pointer is null or points to what its type says.
 */
itpms_status itpms_car_estimate(itpms_car *car, itpms_estimate *estimate);

/*
 Writes the alerts that stand, up to `capacity`, and into `*count` how many there are: at most 27.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, TOO_SMALL (`*count` says what it takes; the first ones are written).

 # Safety
 Every pointer is null or points to what its type says, `alerts` to `capacity` of them.
 */
itpms_status itpms_car_alerts(itpms_car *car, itpms_alert *alerts, size_t capacity, size_t *count);

/*
 Writes the alert `index` of those that stand as a sentence in English, ended by a zero. `*length` (may be null) becomes the bytes that
 all of it takes with its zero: some 200.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, BAD_INDEX, TOO_SMALL (the beginning is written).

 # Safety
 Every pointer is null or points to what its type says, `text` to `capacity` bytes.
 */
itpms_status itpms_car_alert_text(itpms_car *car,
                                  size_t index,
                                  char *text,
                                  size_t capacity,
                                  size_t *length);

/*
 Writes what alerts began or ended since this was last called, and into `*count` how many did: at most 54.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, TOO_SMALL (`*count` says what it takes; nothing is written, and nothing is lost).

 # Safety
 Every pointer is null or points to what its type says, `events` to `capacity` of them.
 */
itpms_status itpms_car_events(itpms_car *car,
                              itpms_event *events,
                              size_t capacity,
                              size_t *count);

/*
 All tires have their placard pressures from the next sample on, for so many seconds (600 are usual), in which the car should be driven:
 what it differs by from its configuration is learned.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, BAD_DURATION.

 # Safety
 `car` is null or a car.
 */
itpms_status itpms_car_begin_calibration(itpms_car *car,
                                         double seconds);

/*
 Ends the calibration that is under way with what it has seen.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, NOT_CALIBRATED (it is ended, and taught nothing).

 # Safety
 `car` is null or a car.
 */
itpms_status itpms_car_end_calibration(itpms_car *car);

/*
 Writes what a calibration taught, once it is over, to be stored: some hundred bytes, at most `ITPMS_CALIBRATION_MAX_SIZE`; `*written`
 becomes how many.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, NOT_CALIBRATED, TOO_SMALL.

 # Safety
 Every pointer is null or points to what its type says, `memory` to `size` bytes.
 */
itpms_status itpms_car_save_calibration(itpms_car *car,
                                        void *memory,
                                        size_t size,
                                        size_t *written);

/*
 Begins a drive with a stored calibration, before the first sample.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, DAMAGED, OTHER_FORMAT, OTHER_CAR, IMPLAUSIBLE, TOO_LATE.

 # Safety
 Every pointer is null or points to what its type says, `memory` to `size` bytes.
 */
itpms_status itpms_car_load_calibration(itpms_car *car, const void *memory, size_t size);

/*
 Bytes that `itpms_car_save_state` takes now; 0 if `car` is no car.

 # Safety
 `car` is null or a car.
 */
size_t itpms_car_state_size(itpms_car *car);

/*
 Writes all that a car knows, configuration included, with a version and a checksum: it goes on from there to the same bits.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, TOO_SMALL.

 # Safety
 Every pointer is null or points to what its type says, `memory` to `size` bytes.
 */
itpms_status itpms_car_save_state(itpms_car *car,
                                  void *memory,
                                  size_t size,
                                  size_t *written);

/*
 Goes on from a state that was saved by the same version of the library in the same precision. `car` has been made with any
 configuration; it gets that of the state. Takes several times `itpms_car_size` of stack: a small controller keeps the car's memory
 itself instead.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, DAMAGED, OTHER_FORMAT.

 # Safety
 Every pointer is null or points to what its type says, `memory` to `size` bytes.
 */
itpms_status itpms_car_restore_state(itpms_car *car,
                                     const void *memory,
                                     size_t size);

/*
 Begins anew with the configuration that the car was made with; a calibration is forgotten.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR.

 # Safety
 `car` is null or a car.
 */
itpms_status itpms_car_reset(itpms_car *car);

/*
 Bytes of memory that wheel speeds alone take; at most `ITPMS_WHEELS_MAX_SIZE`.
 */
size_t itpms_wheels_size(void);

/*
 Alignment in bytes of that memory; at most that of a `double`.
 */
size_t itpms_wheels_align(void);

/*
 Makes a monitor of wheel speeds of `size` bytes of memory, as `itpms_car_init` makes a car. Of the configuration `wheelbase_m` and
 `wheel_speeds` are read, and nothing else.

 `problem` may be null; else it says what is wrong with the configuration. Errors: NULL_POINTER, MISALIGNED (memory by
 `itpms_wheels_align`), TOO_SMALL, WRONG_SIZE, WRONG_VERSION, BAD_PARAMETER, BAD_CHOICE; there is no monitor then.

 # Safety
 Every pointer is null or points to memory of its type, `memory` to `size` bytes that nothing else uses.
 */
itpms_status itpms_wheels_init(void *memory,
                               size_t size,
                               const itpms_config *config,
                               itpms_wheels **wheels,
                               itpms_problem *problem);

/*
 Takes a sample and writes what is known after it; `report` may be null. Values that are NaN are missing.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, BAD_TIME and BAD_CHOICE (the sample is left out).

 # Safety
 Every pointer is null or points to what its type says.
 */
itpms_status itpms_wheels_update(itpms_wheels *wheels,
                                 const itpms_wheel_speed_sample *sample,
                                 itpms_radius_report *report);

/*
 Writes what is known after the last sample.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR.

 # Safety
 Every pointer is null or points to what its type says.
 */
itpms_status itpms_wheels_report(itpms_wheels *wheels, itpms_radius_report *report);

/*
 As `itpms_car_alerts`; there is at most 1.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, TOO_SMALL (`*count` says what it takes).

 # Safety
 Every pointer is null or points to what its type says, `alerts` to `capacity` of them.
 */
itpms_status itpms_wheels_alerts(itpms_wheels *wheels, itpms_alert *alerts, size_t capacity, size_t *count);

/*
 As `itpms_car_alert_text`.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, BAD_INDEX, TOO_SMALL (the beginning is written).

 # Safety
 Every pointer is null or points to what its type says, `text` to `capacity` bytes.
 */
itpms_status itpms_wheels_alert_text(itpms_wheels *wheels, size_t index, char *text, size_t capacity, size_t *length);

/*
 As `itpms_car_events`; there are at most 2.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, TOO_SMALL (`*count` says what it takes; nothing is written, and nothing is lost).

 # Safety
 Every pointer is null or points to what its type says, `events` to `capacity` of them.
 */
itpms_status itpms_wheels_events(itpms_wheels *wheels,
                                 itpms_event *events,
                                 size_t capacity,
                                 size_t *count);

/*
 All tires have the pressures they should have from the next sample on, for so many seconds (600 are usual), in which the car should
 be driven: how the tires differ is learned. Nothing is reported without.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, BAD_DURATION.

 # Safety
 `wheels` is null or was made by `itpms_wheels_init`.
 */
itpms_status itpms_wheels_begin_calibration(itpms_wheels *wheels,
                                            double seconds);

/*
 Ends the calibration that is under way with what it has seen; that takes 10 s of driving at least.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, NOT_CALIBRATED (it is ended, and taught nothing).

 # Safety
 `wheels` is null or was made by `itpms_wheels_init`.
 */
itpms_status itpms_wheels_end_calibration(itpms_wheels *wheels);

/*
 Writes what a calibration taught, once it is over, to be stored: 201 bytes in `float`, 385 in `double`; `*written` becomes how many.
 It is not the calibration of a car, and no car takes it.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, NOT_CALIBRATED, TOO_SMALL.

 # Safety
 Every pointer is null or points to what its type says, `memory` to `size` bytes.
 */
itpms_status itpms_wheels_save_calibration(itpms_wheels *wheels,
                                           void *memory,
                                           size_t size,
                                           size_t *written);

/*
 Begins a drive with a stored calibration, before the first sample.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, DAMAGED, OTHER_FORMAT, IMPLAUSIBLE, TOO_LATE.

 # Safety
 Every pointer is null or points to what its type says, `memory` to `size` bytes.
 */
itpms_status itpms_wheels_load_calibration(itpms_wheels *wheels, const void *memory, size_t size);

/*
 Begins anew with the configuration that the monitor was made with; a calibration is forgotten.

 Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR.

 # Safety
 `wheels` is null or was made by `itpms_wheels_init`.
 */
itpms_status itpms_wheels_reset(itpms_wheels *wheels);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* ITPMS_H */
