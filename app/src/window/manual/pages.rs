//! Which page of the manual belongs to which screen. The pages are inside of the program, so that help is
//! there where only the program is.

use crate::operator::Screen;

/// A page: what it is called, and its text in Markdown.
pub type Page = (&'static str, &'static str);

macro_rules! page {
    ($title:literal, $file:literal) => {
        ($title, include_str!(concat!("../../../../docs/", $file)))
    };
}

const COMMISSION: Page = page!("Commission", "commissioning.md");
const LIVE: Page = page!("Live", "live.md");
const EYES: Page = page!("Eyes", "eyes.md");
const MOUNT: Page = page!("Mount", "mount.md");
const TOUCH: Page = page!("Touch", "touch.md");
const MODELS: Page = page!("Models", "models.md");
const GAP: Page = page!("Gap", "gap.md");
const HAND_EYE: Page = page!("Hand-eye", "hand-eye.md");
const GRASP: Page = page!("Grasp", "grasp.md");
const DRIFT: Page = page!("Drift", "drift.md");
const TIMELINE: Page = page!("Timeline", "timeline.md");
const ROBOT: Page = page!("Robot", "robot.md");
const DETECT: Page = page!("Detect", "detect.md");
const TROUBLE: Page = page!("When something is wrong", "trouble.md");

/// Every page, in the order of work.
pub const ALL: [Page; 14] = [
    COMMISSION, LIVE, EYES, MOUNT, TOUCH, MODELS, GAP, HAND_EYE, GRASP, DRIFT, TIMELINE, ROBOT, DETECT,
    TROUBLE,
];

/// The page of a screen.
pub fn of(screen: Screen) -> Page {
    match screen {
        Screen::Commission => COMMISSION,
        Screen::Live => LIVE,
        Screen::Collect | Screen::Judge | Screen::Accept => EYES,
        Screen::Mount => MOUNT,
        Screen::Touch => TOUCH,
        Screen::Models => MODELS,
        Screen::Gap => GAP,
        Screen::HandEye => HAND_EYE,
        Screen::Grasp => GRASP,
        Screen::Drift => DRIFT,
        Screen::Timeline => TIMELINE,
        Screen::Robot => ROBOT,
        Screen::Scores | Screen::Images => DETECT,
    }
}
