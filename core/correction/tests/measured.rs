//! On touches of the real robot. Without the data each test says so and passes.

use std::time::Instant;

use plumbline_correction::{Method, Recipe, TouchData, TrainOptions, compare, spread_of_repeats, train};
use plumbline_model::robot::Rig;
use plumbline_model::{Pixel, Session, Unattended, measured_data};

fn touch_245() -> Option<TouchData> {
    let folder = match measured_data::folder("nico-touch") {
        Ok(folder) => folder,
        Err(reason) => {
            eprintln!("{reason}");
            return None;
        }
    };
    let session = Session::read(&folder.join("touch-245")).expect("a session");
    let rig = Rig::built_in("nico").expect("the rig that comes with the program");
    let tip = &session.manifest.chain.as_ref().expect("it has touches").tip;
    let chain = rig.chain(tip).expect("a tip of the rig");
    Some(TouchData::of_session(&session, &chain).expect("touches to learn from"))
}

#[test]
fn held_out_errors_and_time() {
    let Some(data) = touch_245() else { return };
    assert_eq!(data.len(), 245);
    assert_eq!(spread_of_repeats(&data), None);
    for method in Method::ALL {
        let start = Instant::now();
        let mut points = 0;
        let model = train(&data, method, &TrainOptions::default(), &Unattended, &mut |_| points += 1)
            .expect("it trains");
        let seconds = start.elapsed().as_secs_f64();
        let trained = model.provenance().training.expect("trained here");
        let held_out = model.provenance().cross_validation.as_ref().expect("cross-validated");
        eprintln!("{} {seconds:.3} s, {points} loss points", method.name());
        eprintln!("  trained  {trained:?}");
        eprintln!("  held out {:?} {:?}", held_out.errors, held_out.mean_2d_interval_m);
    }
    let start = Instant::now();
    let comparison =
        compare(&data, &Method::ALL, &TrainOptions::default(), &Unattended).expect("it compares");
    eprintln!("compare {:.3} s", start.elapsed().as_secs_f64());
    eprintln!("M1 − M3 {:?}", comparison.difference_m(Method::M1, Method::M3));
    let _ = (Recipe::Published, Pixel::<plumbline_model::session::Screen>::new(0.0, 0.0));
}
