//! The motors in the servos, as identified on real ones.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::error::TwinError;

const DATA: &str = include_str!("../../data/servos.toml");

/// A motor with its gear and its position control, at the output of the gear.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Motor {
    kt_nm_per_a: f64,
    resistance_ohm: f64,
    /// Inertia of the rotor as felt at the output, kg m².
    pub armature_kgm2: f64,
    friction_base_nm: f64,
    friction_stribeck_nm: f64,
    load_friction_stribeck: f64,
    stribeck_speed_rad_s: f64,
    stribeck_exponent: f64,
    friction_viscous_nms: f64,
    supply_v: f64,
    /// Share of the full voltage per rad of error.
    pub duty_per_rad: f64,
}

impl Motor {
    /// The motor of a servo model.
    pub(crate) fn of(model: &str) -> Result<Self, TwinError> {
        let models: BTreeMap<String, Self> = toml::from_str(DATA)
            .map_err(|error| TwinError::Physics { reason: format!("motor data: {error}") })?;
        models.get(model).copied().ok_or_else(|| TwinError::UnknownServo {
            model: model.to_owned(),
            known: models.keys().cloned().collect::<Vec<_>>().join(", "),
        })
    }

    /// Torque at full voltage and standstill, Nm.
    pub(crate) fn stall_nm(&self) -> f64 {
        self.kt_nm_per_a * self.supply_v / self.resistance_ohm
    }

    /// Torque per speed that back-EMF and grease take, Nm s/rad.
    pub(crate) fn damping_nms(&self) -> f64 {
        self.kt_nm_per_a * self.kt_nm_per_a / self.resistance_ohm + self.friction_viscous_nms
    }

    /// Speed at full voltage without load, rad/s.
    pub(crate) fn no_load_rad_s(&self) -> f64 {
        self.supply_v / self.kt_nm_per_a
    }

    /// Dry friction (Nm) at a speed (rad/s) with the gear under a load (Nm).
    pub(crate) fn friction_nm(&self, speed_rad_s: f64, gear_load_nm: f64) -> f64 {
        let slow = (-(speed_rad_s.abs() / self.stribeck_speed_rad_s).powf(self.stribeck_exponent)).exp();
        self.friction_base_nm
            + slow * (self.friction_stribeck_nm + self.load_friction_stribeck * gear_load_nm.abs())
    }
}

/// Motor temperature from what it works: one node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MotorHeat {
    /// °C.
    pub temperature_c: f64,
    /// Additional heating that a fault switched on, K/s.
    pub extra_k_per_s: f64,
}

/// Room temperature, °C.
pub(crate) const ROOM_C: f64 = 23.0;
/// Heating at full load, K/s.
const HEATING_K_PER_S: f64 = 0.25;
/// Time constant of cooling, s.
const COOLING_S: f64 = 400.0;

impl Default for MotorHeat {
    fn default() -> Self {
        Self { temperature_c: 31.0, extra_k_per_s: 0.0 }
    }
}

impl MotorHeat {
    /// Time passes at a load (share of the stall torque).
    pub(crate) fn pass(&mut self, dt_s: f64, load: f64) {
        // A servo that holds nothing is still warmer than the room.
        let idle_k_per_s = 8.0 / COOLING_S;
        let cooling = (self.temperature_c - ROOM_C) / COOLING_S;
        let heating = HEATING_K_PER_S * load * load + idle_k_per_s + self.extra_k_per_s;
        self.temperature_c = (self.temperature_c + dt_s * (heating - cooling)).min(150.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mx64_is_as_its_maker_says() {
        let motor = Motor::of("MX-64").expect("known");
        // Maker: 6.0 Nm stall and 63 rpm at 12 V.
        assert!((motor.stall_nm() - 6.0).abs() < 0.5, "{}", motor.stall_nm());
        assert!((motor.no_load_rad_s() - 6.6).abs() < 0.8, "{}", motor.no_load_rad_s());
        // Gain 32: 25 to 40 Nm/rad.
        let stiffness = motor.stall_nm() * motor.duty_per_rad;
        assert!((25.0..40.0).contains(&stiffness), "{stiffness}");
    }

    #[test]
    fn friction_falls_with_speed_and_grows_with_load() {
        let motor = Motor::of("MX-64").expect("known");
        assert!(motor.friction_nm(0.0, 1.0) > motor.friction_nm(0.0, 0.0) + 0.2);
        assert!(motor.friction_nm(5.0, 1.0) < motor.friction_nm(0.0, 1.0));
        assert!(motor.friction_nm(5.0, 0.0) > 0.06);
    }

    #[test]
    fn an_unknown_model_is_told_with_those_that_are_known() {
        let error = Motor::of("AX-12").expect_err("no data").to_string();
        assert!(error.contains("AX-12") && error.contains("MX-64"), "{error}");
    }

    #[test]
    fn a_loaded_motor_warms_and_cools_again() {
        let mut heat = MotorHeat::default();
        for _ in 0..600 {
            heat.pass(1.0, 0.5);
        }
        let warm = heat.temperature_c;
        assert!((40.0..65.0).contains(&warm), "{warm}");
        for _ in 0..3000 {
            heat.pass(1.0, 0.0);
        }
        assert!((heat.temperature_c - 31.0).abs() < 0.5);
    }
}
