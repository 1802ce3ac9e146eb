//! Where in a recording what stands.

/// A stream of messages of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Topic {
    /// Images of the left eye.
    LeftEye,
    /// Images of the right eye.
    RightEye,
    /// Lens of the left eye.
    LeftCalibration,
    /// Lens of the right eye.
    RightCalibration,
    /// Angles of joints.
    Joints,
    /// Angles that joints hold or go to, as they were commanded.
    Goals,
    /// Messages for the operator.
    Notes,
    /// What was asked for.
    Commands,
    /// What was seen in images, and where it is.
    Detections,
    /// How the eyes were when a pair was taken: for how long they had been on, and how the head stood.
    Eyes,
    /// Where the eyes were in the robot.
    Transforms,
    /// What was seen, to be drawn over the image of the left eye.
    LeftAnnotations,
    /// The same of the right eye.
    RightAnnotations,
}

impl Topic {
    /// All of them.
    pub const ALL: [Self; 13] = [
        Self::LeftEye,
        Self::RightEye,
        Self::LeftCalibration,
        Self::RightCalibration,
        Self::Joints,
        Self::Goals,
        Self::Notes,
        Self::Commands,
        Self::Detections,
        Self::Eyes,
        Self::Transforms,
        Self::LeftAnnotations,
        Self::RightAnnotations,
    ];

    /// Its name in the file.
    pub fn name(self) -> &'static str {
        match self {
            Self::LeftEye => "/eyes/left/image",
            Self::RightEye => "/eyes/right/image",
            Self::LeftCalibration => "/eyes/left/calibration",
            Self::RightCalibration => "/eyes/right/calibration",
            Self::Joints => "/joints",
            Self::Goals => "/joints/goals",
            Self::Notes => "/notes",
            Self::Commands => "/commands",
            Self::Detections => "/detections",
            Self::Eyes => "/eyes/state",
            Self::Transforms => "/tf",
            Self::LeftAnnotations => "/eyes/left/annotations",
            Self::RightAnnotations => "/eyes/right/annotations",
        }
    }

    /// The topic of a name; `None`: of another program.
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|topic| topic.name() == name)
    }
}
