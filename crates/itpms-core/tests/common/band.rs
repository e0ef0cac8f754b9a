//! Zero-phase band-pass, to compare two roads where a filter claims to know them.

/// `signal` between `low_hz` and `high_hz`: second-order Butterworth edges, each run forwards and backwards.
pub fn band_pass(signal: &[f64], rate_hz: f64, low_hz: f64, high_hz: f64) -> Vec<f64> {
    both_ways(&both_ways(signal, low_hz, rate_hz, Edge::High), high_hz, rate_hz, Edge::Low)
}

#[derive(Clone, Copy)]
enum Edge {
    High,
    Low,
}

fn both_ways(signal: &[f64], hz: f64, rate_hz: f64, edge: Edge) -> Vec<f64> {
    let c = 1.0 / (std::f64::consts::PI * hz / rate_hz).tan();
    let a0 = c * c + 2f64.sqrt() * c + 1.0;
    let a = [2.0 * (1.0 - c * c) / a0, (c * c - 2f64.sqrt() * c + 1.0) / a0];
    let b = match edge {
        Edge::High => [c * c / a0, -2.0 * c * c / a0, c * c / a0],
        Edge::Low => [1.0 / a0, 2.0 / a0, 1.0 / a0],
    };
    let once = |signal: Vec<f64>| {
        let mut held = [0.0; 2];
        let mut out: Vec<f64> = signal
            .into_iter()
            .map(|v| {
                let y = b[0] * v + held[0];
                held = [b[1] * v - a[0] * y + held[1], b[2] * v - a[1] * y];
                y
            })
            .collect();
        out.reverse();
        out
    };
    once(once(signal.to_vec()))
}
