//! The numbers of radius analysis.

crate::tuning::tuning! {
    /// Numbers of radius analysis: its model of radii, roads and slip, what counts and how surely (docs/math/wheel-speed.md). Log ratios of speeds
    /// and changes of radii are in thousandths, yaw rates beside them in 1e-3 rad/s.
    pub struct Tuning {
        // Which half seconds count.
        /// Speed in m/s below which wheel speeds are too coarse.
        least_speed_m_s: f64 = 5.0,
        /// Lateral acceleration in m/s² above which tires creep sideways.
        most_lateral_m_s2: f64 = 1.5,
        /// Force per mass in m/s² below which brakes are on, which look like a radius; the same of the speed's slope, which does not know the grade.
        braking_m_s2: [f64; 2] = [-0.25, -0.4],
        /// Force in m/s², forward or sideways, above which slip is not proportional to it any more.
        most_force_m_s2: f64 = 2.5,
        /// Acceleration in m/s² above which a coupled driven axle hides its tires, and force above which a car with two of them does not coast.
        coupled_m_s2: [f64; 2] = [0.3, 0.15],
        /// What a road that differs from left to right may do to a ratio: slip that does as much hides it, and a yaw rate may leave as much.
        sides: f64 = 1.0,
        /// Ratio of two wheels that is none of radii; it is a sensor's where a road's would have passed.
        absurd_ratio: f64 = 30.0,
        /// Usable driving in s that teaches a calibration anything.
        least_calibration_s: f64 = 10.0,

        // A block's noise (eq. 7).
        /// Least variance of a block's ratio, in 1e-6: what its speeds' steps leave has to be less.
        block_noise: f64 = 0.0025,
        /// Share of the spread within a block that its mean keeps; twice that between the axles without a yaw rate.
        spread_share: f64 = 0.07,
        /// Noise per m/s² to the side, without a yaw rate and with one, by which the bend's load is learned.
        per_lateral: [f64; 2] = [0.2, 0.1],
        /// Noise as a share of the bend that is taken off: a yaw rate's gain, a track.
        per_bend: f64 = 0.02,
        /// Noise of a driven axle as a share of its slip.
        per_slip: f64 = 0.05,

        // Radii.
        /// Sd of the ratios front, rear and between the axles of a car nothing is known of.
        offset_sd: [f64; 3] = [4.0, 4.0, 6.0],
        /// Walk of a radius per √s by itself, and in a leak.
        walk: [f64; 2] = [0.01, 4.0],
        /// Leaks that begin, and end, per s.
        leaks_per_s: [f64; 2] = [1e-5, 0.1],
        /// Share of blocks that are outliers, and their variance over that of others.
        outliers: [f64; 2] = [0.02, 64.0],
        /// How far radii of tires that are not low move by themselves, while the car is driven and from one drive to another.
        fine_sd: [f64; 2] = [0.1, 0.2],
        /// By how much more than another a tire becomes smaller by wear, per km, and with the air that its rubber lets through, per day.
        wear: [f64; 2] = [1.2e-4, 0.003],
        /// Radius over load: 6.4e-4 of it for a tenth more.
        per_load: f64 = -6.4,
        /// Effect of a front passenger on the three ratios.
        passenger: [f64; 3] = [-0.3, -0.2, 0.2],
        /// What a bend's load does to the ratio of each axle, per m/s² to the left, its sd beforehand, and that of its change while the car stands.
        bend: [f64; 3] = [-0.5, 0.5, 0.1],

        // Slip of the driven axle.
        /// Slip per m/s² before anything was learned, and its sd.
        slip: [f64; 2] = [3.5, 2.0],
        /// Slip on a dry road of the stiffest tires, and from where on no road is dry.
        dry_slip: [f64; 2] = [2.0, 10.0],
        /// By which share of it slip, which is the road's, the load's and the day's, may change until another drive, while the car stands, per √s.
        slip_changes: [f64; 3] = [1.0, 0.25, 0.01],
        /// Share of their slip by which a driven axle's wheels slip unequally, as loads, tires and road differ: beforehand and after each stop.
        unequal_share: f64 = 0.25,
        /// What changes where a road does at once, in an outlier: slip by this share of it, how unequally driven wheels slip by this share of it.
        road_changes: [f64; 2] = [0.3, 0.15],
        /// Slip over a dry road's beyond which a road is slippery: left and right differ from place to place.
        slippery: f64 = 1.8,
        /// Share of that excess by which driven wheels differ: from one place to the next, per √s, and as noise.
        places: [f64; 3] = [0.5, 0.1, 0.3],

        // Disturbances that wander: sd, and time in s.
        /// Of a measured yaw rate.
        yaw_measured: [f64; 2] = [0.85, 1.0],
        /// Of the yaw rate where none is measured.
        yaw_unknown: [f64; 2] = [65.0, 4.0],
        /// Of the difference of the front wheels, of the rear ones, of both alike by a road's sides (in an outlier twice that); and their time.
        of_an_axle: [f64; 4] = [0.16, 0.22, 0.2, 25.0],
        /// Of the difference of the axles where their force is measured.
        force_measured: [f64; 2] = [0.3, 20.0],
        /// Of the same by the speed alone: with a yaw rate, without one; and their time.
        force_by_speed: [f64; 3] = [1.35, 1.65, 13.0],
        /// Sd of a yaw rate's offset beforehand; it is known from a quarter of that on.
        yaw_bias_sd: f64 = 20.0,

        // Which tires are low.
        /// Loss of an empty tire, always a single one, in losses of a fifth of the `ln`, and its sd: half to all but a thirtieth of its pressure.
        empty: [f64; 2] = [9.0, 3.0],
        /// Sds of the three ratios under causes outside these hypotheses: snow, a coupling, another tire.
        unexplained_sd: [f64; 3] = [4.0, 4.0, 10.0],
        /// How much larger a loss while driving is that is found in half of the drives than prior and threshold ask for.
        driving_margin: f64 = 1.25,
        /// Usable driving in s over which a state has to be sure: at the least; where it is open which tire it is, or a road, a load or a slip,
        /// which pass, explain it, too; on a slippery road, which it counts as for so long after it was seen to be.
        sure_for_s: [f64; 3] = [4.0, 30.0, 300.0],

        // A slow leak over days.
        /// Days below which nothing is said.
        least_days: u32 = 4,
        /// Mean, and as large an sd, of what a leak takes off a radius a day; twice that is the sd of rates that no leak of one tire explains.
        leak_per_day: f64 = 0.15,

        // Whether wheels and yaw rate follow the car.
        /// Time in s after which a ratio, or a yaw rate, counts as usual: bends are shorter.
        usual_s: f64 = 10.0,
        /// Time in s after which is forgotten how the wheels followed, how the yaw rate did, and whether axles are coupled.
        memory_s: [f64; 3] = [30.0, 120.0, 600.0],
        /// Accelerations over the speed that have to be seen, as a sum of squares in 1/s².
        speeding_seen: f64 = 0.003,
        /// Ratios made by bends that have to be seen, as a sum of squares in 1e-6: for a doubt, and to be sure.
        bends_seen: [f64; 2] = [100.0, 1000.0],
        /// Delay in s from which on a speed comes late, a loss may be one, and a front and a rear wheel may be exchanged.
        late_s: [f64; 3] = [0.06, 0.03, 0.012],
        /// Share of a yaw rate that a sensor may leave by its own, and what of a radius a bend's load takes per m/s², which imitates a yaw rate.
        yaw_off: [f64; 2] = [0.2, 8e-4],
        /// What may be left of a yaw rate beyond that in rad²/s²: two tires of a side that lose a quarter at once leave 0.008.
        yaw_left: f64 = 0.01,
        /// Radius of a bend in m from which on a preload may keep the wheels of an axle alike.
        wide_m: f64 = 300.0,
        /// Share of bends that the wheels of an axle follow that are free, or coupled.
        followed: [f64; 2] = [0.85, 0.75],
    }
}
