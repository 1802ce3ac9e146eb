use std::sync::Arc; use std::time::Duration;
use plumbline_hardware::{joints::*, dynamixel::*};
use plumbline_model::robot::Rig;
use plumbline_twin::*;
fn main(){
 let rig=Arc::new(Rig::built_in("nico").unwrap());
 for name in ["nominal","lab"] {
  let Ok(sc)=Scenario::built_in(name) else {eprintln!("no {name}: {:?}", Scenario::built_in_names().collect::<Vec<_>>()); continue};
  let twin=Twin::start(TwinSettings{rig:rig.clone(),scenario:sc,seed:1,pace:1.0}).unwrap();
  std::thread::sleep(Duration::from_millis(300));
  let port=open_port(&twin.port().to_string_lossy(),1_000_000).unwrap();
  let d=ArmDriver::connect(port,rig.clone(),ArmOptions::default()).unwrap();
  eprintln!("{name}: {:?} {:?}", d.scan().problems(), d.state().motion);
  let show=|d:&ArmDriver| { let s=d.state(); let mut v:Vec<_>=s.joints.iter().filter_map(|j| Some((((j.goal_rad?-j.angle_rad?).to_degrees()*10.0).round()/10.0, rig.servo_of(j.joint)?.title.clone(), j.load.map(|l|(l*100.).round())))).collect(); v.sort_by(|a,b| b.0.abs().total_cmp(&a.0.abs())); v.truncate(4); eprintln!("   sag {v:?} cyc {:?} faults {} gone {:?}", s.bus.complete_per_s, s.bus.counts.faults, s.gone); };
  d.engage(&[]).unwrap(); std::thread::sleep(Duration::from_millis(800)); show(&d);
  for pose in rig.poses.iter().chain(rig.poses.iter().take(1)) {
    let id=d.start_move(Move{goals:pose.joints.clone(),pace:Pace::PeakSpeed(0.5)}).unwrap();
    let t=std::time::Instant::now();
    let o=d.wait_for(id,Duration::from_secs(25));
    eprintln!(" {} -> {:?} in {:.1} s (planned {:?})",pose.name,o,t.elapsed().as_secs_f64(), 0);
    show(&d);
  }
 }
}
