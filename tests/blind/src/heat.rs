//! Servos warm up: motor, then the bracket behind it, then the room.

/// Heat capacities (J/K) of motor and bracket, conductances (W/K) between them and to the room,
/// power (W).
const MOTOR_J_PER_K: f64 = 60.0;
const BRACKET_J_PER_K: f64 = 45.0;
const INNER_W_PER_K: f64 = 0.25;
const OUTER_W_PER_K: f64 = 0.18;
const POWER_W: f64 = 2.4;
/// Temperature of the room, °C.
const ROOM_C: f64 = 23.0;

/// Temperature of the motor (°C), and how far the bracket has warmed (0 cold, 1 as warm as it
/// gets), a time after the power came on (s).
pub fn after(t_secs: f64) -> (f64, f64) {
    let (mut motor_k, mut bracket_k) = (0.0, 0.0);
    let steps = (t_secs / 2.0).ceil().max(1.0);
    let dt = t_secs / steps;
    for _ in 0..steps as usize {
        let inner_w = INNER_W_PER_K * (motor_k - bracket_k);
        motor_k += dt * (POWER_W - inner_w) / MOTOR_J_PER_K;
        bracket_k += dt * (inner_w - OUTER_W_PER_K * bracket_k) / BRACKET_J_PER_K;
    }
    (ROOM_C + motor_k, bracket_k * OUTER_W_PER_K / POWER_W)
}

#[cfg(test)]
mod tests {
    use super::after;

    #[test]
    fn the_bracket_follows_the_motor_late_and_ends_where_power_leaves() {
        let (motor_c, bracket) = after(60.0);
        assert!(motor_c > 24.0 && bracket < 0.1, "{motor_c} {bracket}");
        assert!((after(20_000.0).1 - 1.0).abs() < 1e-3);
    }
}
