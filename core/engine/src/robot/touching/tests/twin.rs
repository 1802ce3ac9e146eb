//! The same on the twin, through its pseudo-terminal: the physics says where the glass is touched.
#![allow(clippy::print_stdout)]

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_model::Pixel;
use plumbline_model::robot::{JointIndex, Posture, Rig};
use plumbline_model::touch_plan::Side;

use crate::ground::bell::Bell;
use crate::ground::slot::{Taker, newest_value_slot};
use crate::ground::watched::{Pulse, Trial, WatchedThread};
use crate::motion::{Planner, ScreenPlace, TouchPace, Wanted};
use crate::robot::command::RobotCommand;
use crate::robot::control::RobotControl;
use crate::robot::touch_order::{TouchNews, TouchOrder, TouchRun};
use crate::robot::{News, RobotThread, RobotWires, Switches, Worker};
use crate::twin::{TwinDesk, TwinEyesPlug};

/// Beside other tests the physics of the twin is slower than its clock.
const PATIENCE: Duration = Duration::from_secs(120);

struct Bench {
    thread: RobotThread,
    news: Taker<News>,
    touches: crossbeam_channel::Receiver<TouchNews>,
    notes: crossbeam_channel::Receiver<(crate::ground::notice::NoticeLevel, String)>,
    switches: Switches,
    rig: Arc<Rig>,
    measured: Option<Posture>,
    _folder: tempfile::TempDir,
}

impl Bench {
    fn start(scenario: &str) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let rig = Arc::new(Rig::built_in("nico").expect("the rig that comes with the program"));
        let switches = Switches::default();
        let desk = TwinDesk::new(TwinEyesPlug::default());
        let worker = Worker::new(rig.clone(), folder.path(), switches.clone(), desk);
        let (news_in, news) = newest_value_slot();
        let (touches_in, touches) = crossbeam_channel::bounded(64);
        let (notes_in, notes) = crossbeam_channel::bounded(64);
        let (bell, _) = Bell::new();
        let pulse = Pulse::new(WatchedThread::Robot, bell.clone(), Trial::default());
        let wires = RobotWires { news: news_in, touches: touches_in, notes: notes_in, bell };
        let thread = RobotThread::start(worker, wires, pulse).expect("a thread");
        let scenario = scenario.to_owned();
        assert!(thread.control(RobotCommand::ConnectTwin { scenario }.into()));
        Self { thread, news, touches, notes, switches, rig, measured: None, _folder: folder }
    }

    fn look(&mut self) {
        self.switches.heartbeat.beat();
        if let Some(news) = self.news.take() {
            self.measured = news.robot.measured.clone();
        }
        std::thread::sleep(Duration::from_millis(5));
    }

    fn present(&mut self) -> Posture {
        let began = Instant::now();
        while self.measured.is_none() {
            self.look();
            assert!(began.elapsed() < PATIENCE, "{:?}", self.notes.try_iter().collect::<Vec<_>>());
        }
        self.measured.clone().expect("just seen")
    }

    /// How the touch ended.
    fn touch(&mut self, order: TouchOrder) -> TouchRun {
        assert!(self.thread.control(RobotControl::Touch(Box::new(order))));
        let began = Instant::now();
        loop {
            self.look();
            for news in self.touches.try_iter() {
                match news.state {
                    TouchRun::Doing(_) => {}
                    end => return end,
                }
            }
            assert!(began.elapsed() < PATIENCE, "{:?}", self.notes.try_iter().collect::<Vec<_>>());
        }
    }
}

#[test]
fn on_a_robot_as_described_the_finger_lands_where_it_is_sent() {
    let mut bench = Bench::start("perfect");
    let planner = Planner::new(&bench.rig, "right_index_tip", ScreenPlace::Measured)
        .expect("it can point at the screen");
    let pace = TouchPace::default().at(2.0);
    let pitch_m = bench.rig.touchscreen.pitch_m();
    let targets =
        [([700.0, 800.0], Side::Above), ([960.0, 600.0], Side::Left), ([1500.0, 450.0], Side::Right)];
    for (i, ([u_px, v_px], side)) in targets.into_iter().enumerate() {
        let target = Pixel::new(u_px, v_px);
        let sent = bench.rig.touchscreen.point_at(target);
        let from = bench.present();
        let path = planner.plan(&Wanted::straight(target, sent, side), &from).expect("in reach");
        let estimated = path.duration(&pace);
        let chain = planner.chain().clone();
        let order = TouchOrder::along(path, &chain, &bench.rig.touchscreen, &pace, i + 1, i as u64 + 1);
        let touched = Instant::now();
        let end = bench.touch(order);
        let took = touched.elapsed();
        let TouchRun::Touched(measured) = end else { panic!("{end:?}") };
        let error_m = [(measured.pixel.u_px - u_px) * pitch_m[0], (measured.pixel.v_px - v_px) * pitch_m[1]];
        let commanded: Vec<f64> = measured.commanded_rad.iter().map(|a| a.expect("commanded")).collect();
        let tip = chain.robot_from_tip(&commanded).translation_m();
        println!(
            "{side:?}: {:.2} mm beside the target, commanded {:.2} mm below the glass, {took:.1?} (estimated {estimated:.1?})",
            1e3 * error_m[0].hypot(error_m[1]),
            1e3 * (sent.coords.z - tip.z)
        );
        assert!(error_m[0].hypot(error_m[1]) < 2e-3, "{error_m:?}");
        assert!((tip.z - sent.coords.z).abs() < 3e-3, "{}", tip.z - sent.coords.z);
        assert!(measured.encoder_rad.iter().all(Option::is_some), "{measured:?}");
        assert!(measured.later_encoder_rad.iter().all(Option::is_some), "{measured:?}");
    }
}

/// Through every guard of the bus: it stands two centimeters higher than its encoders say, so that sent to the
/// glass it ends in the air, and sent as much lower as that it lands where it is sent.
#[test]
fn an_arm_that_stands_higher_than_its_encoders_say_is_sent_lower_and_meets_the_glass() {
    let rig = Rig::built_in("nico").expect("the rig that comes with the program");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("high.toml");
    let chain = rig.chain("right_index_tip").expect("a tip");
    let ready = rig.pose("touch-ready").expect("a pose").applied_to(&rig.home());
    // The joint that raises the tip most, turned so far that it is 20 mm higher; the sign is the twin's own affair, so
    // that both are tried.
    let height_m = |joint: JointIndex, by_rad: f64| {
        let turned = ready.with(&[joint], &[ready[joint] + by_rad]);
        chain.robot_from_tip_in(&turned).translation_m().z
    };
    let m_per_rad = |joint: JointIndex| (height_m(joint, 0.05) - height_m(joint, -0.05)) / 0.1;
    let slopes = chain.joints().iter().map(|joint| (*joint, m_per_rad(*joint)));
    let (joint, slope) = slopes.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).expect("it has joints");
    let (zero_rad, name) = (0.02 / slope, &rig.description.joint(joint).name);
    assert!(zero_rad.abs() < 0.2, "{name}: {zero_rad}");
    let mut ended = vec![];
    for zero_rad in [zero_rad, -zero_rad] {
        let text = format!(
            "format = 1\nname = \"high\"\ntitle = \"High\"\nabout = \"It stands high.\"\n[servo]\nholding = \"exact\"\n\
             [joint.{name}]\nencoder_zero_rad = {zero_rad}\n"
        );
        std::fs::write(&file, text).expect("written");
        let mut bench = Bench::start(file.to_str().expect("a name"));
        let planner = Planner::new(&bench.rig, "right_index_tip", ScreenPlace::Measured).expect("it points");
        let target = Pixel::new(1150.0, 650.0);
        let straight = Wanted::straight(target, bench.rig.touchscreen.point_at(target), Side::Above);
        let pace = TouchPace::default().at(2.0);
        for (number, deeper_m) in [(1, 0.0), (2, 0.024)] {
            let from = bench.present();
            let path = planner.plan(&straight.deeper(deeper_m), &from).expect("in reach");
            let chain = planner.chain().clone();
            let order = TouchOrder::along(path, &chain, &bench.rig.touchscreen, &pace, number, number as u64);
            let end = bench.touch(order);
            println!("zero {zero_rad:.3} rad, {:.0} mm lower: {end:?}", 1e3 * deeper_m);
            ended.push(end);
        }
    }
    // One of the two arms stands high, the other low: that one meets the glass early.
    let high = ended.chunks(2).find(|ends| ends[0] == TouchRun::MetNothing).expect("one stands high");
    let TouchRun::Touched(met) = &high[1] else { panic!("{:?}", high[1]) };
    // By the zero that nobody knows, and no farther.
    let off_px = (met.pixel.u_px - 1150.0).hypot(met.pixel.v_px - 650.0);
    assert!(off_px < 200.0, "{off_px} px");
    let low = ended.chunks(2).find(|ends| ends[0] != TouchRun::MetNothing).expect("one stands low");
    assert!(matches!(low[0], TouchRun::Touched(_)), "{:?}", low[0]);
}
