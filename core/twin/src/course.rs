//! What the joints of a twin without a clock do, while somebody wants to know.

use plumbline_model::robot::Posture;

use crate::physics::World;

/// All joints at a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct CoursePoint {
    /// Simulated time, s.
    pub at_s: f64,
    /// What was commanded last.
    pub commanded: Posture,
    /// What the encoders say, in whole ticks.
    pub encoders: Posture,
}

/// Points that were not taken yet.
#[derive(Debug)]
pub(crate) struct Course {
    /// Steps of the physics between two points.
    every: usize,
    /// Steps since the last one.
    steps: usize,
    points: Vec<CoursePoint>,
}

impl Course {
    /// A point this often, beginning with this one.
    pub fn new(every_s: f64, first: CoursePoint) -> Self {
        let every = ((every_s / World::STEP_S).round() as usize).max(1);
        Self { every, steps: 0, points: vec![first] }
    }

    /// A step was made: whether it is time for a point.
    pub fn is_due(&mut self) -> bool {
        self.steps = (self.steps + 1) % self.every;
        self.steps == 0
    }

    pub fn add(&mut self, point: CoursePoint) {
        self.points.push(point);
    }

    pub fn take(&mut self) -> Vec<CoursePoint> {
        std::mem::take(&mut self.points)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_model::robot::Rig;

    use crate::{Lockstep, Scenario};

    #[test]
    fn a_course_has_a_point_as_often_as_asked_and_to_keep_it_changes_nothing() {
        let rig = Arc::new(Rig::built_in("nico").expect("comes with the program"));
        let scenario = Scenario::built_in("lab").expect("valid");
        let twin = || Lockstep::new(rig.clone(), &scenario, 3).expect("built");
        let (elbow, home) = (rig.arms[0].joints[3], rig.home());
        let way = [home.with(&[elbow], &[home[elbow] + 0.1])];
        let (mut watched, mut alone) = (twin(), twin());
        assert!(alone.take_course().is_empty(), "nobody asked");
        let began_s = watched.now_s();
        watched.keep_course(0.08);
        for twin in [&mut watched, &mut alone] {
            twin.follow(&way, 0.5);
            twin.wait(0.2);
        }
        assert_eq!((watched.encoders(), watched.now_s()), (alone.encoders(), alone.now_s()));

        let course = watched.take_course();
        let lasted_s = watched.now_s() - began_s;
        assert_eq!(course.len(), (lasted_s / 0.08 + 1e-6) as usize + 1, "{lasted_s} s");
        assert!((course[0].at_s - began_s).abs() < 1e-9 && course[0].commanded == home);
        assert!(course.windows(2).all(|pair| (pair[1].at_s - pair[0].at_s - 0.08).abs() < 1e-6));
        let last = course.last().expect("points");
        assert_eq!(last.commanded, way[0]);
        assert!((last.encoders[elbow] - course[0].encoders[elbow]).abs() > 0.05, "it has moved");
        assert!(watched.take_course().is_empty(), "taken once");
        watched.end_course();
        watched.wait(0.2);
        assert!(watched.take_course().is_empty(), "it is kept no longer");
    }
}
