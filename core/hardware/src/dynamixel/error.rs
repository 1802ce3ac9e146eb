//! What can go wrong with a bus as a whole.

use super::fault::FaultKind;
use super::packet::EncodeError;

/// The bus cannot be opened or used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BusError {
    /// No such device.
    #[error("there is no port {port}: plug the adapter in, or choose another port")]
    NoSuchPort {
        /// As asked for.
        port: String,
    },
    /// Another program has it.
    #[error(
        "{port} is used by another program: close that program (or the other window of this one), then connect again"
    )]
    InUse {
        /// The port.
        port: String,
    },
    /// No permission.
    #[error(
        "{port} may not be used by this account: add the account to the group that owns the port (often dialout), then log in again"
    )]
    NotAllowed {
        /// The port.
        port: String,
    },
    /// The adapter does not do that.
    #[error(
        "{port} does not offer {baud} bits per second ({detail}): use an adapter that does, or change the rate in the rig file"
    )]
    BaudRate {
        /// The port.
        port: String,
        /// Asked for.
        baud: u32,
        /// What the system says.
        detail: String,
    },
    /// Something else.
    #[error("{port} cannot be opened ({detail}): unplug the adapter and plug it in again")]
    CannotOpen {
        /// The port.
        port: String,
        /// What the system says.
        detail: String,
    },
    /// The list of ports cannot be had.
    #[error("the system does not list its ports ({detail}): give the port's path by hand")]
    NoList {
        /// What the system says.
        detail: String,
    },
    /// It was there and is gone.
    #[error("{port} is gone ({detail}): check the cable and the adapter, then connect again")]
    PortGone {
        /// The port.
        port: String,
        /// What the system says.
        detail: String,
    },
    /// A servo does not answer rightly.
    #[error("servo {id}: {kind} after {attempts} attempts: check its power and its cable")]
    Servo {
        /// Servo.
        id: u8,
        /// The last attempt's fault.
        kind: FaultKind,
        /// How often it was asked.
        attempts: u32,
    },
    /// A register the model does not have.
    #[error("{model} has no such register: choose one of its control table")]
    NoRegister {
        /// The model.
        model: String,
    },
    /// An instruction that cannot be sent.
    #[error(transparent)]
    Encode(#[from] EncodeError),
    /// The stop was pressed while waiting.
    #[error("interrupted by the stop")]
    Interrupted,
    /// The operating system refused a thread.
    #[error("no thread could be started ({detail}): close other programs and connect again")]
    NoThread {
        /// What the system says.
        detail: String,
    },
    /// Nobody answers.
    #[error(
        "no servo answers on {port}: switch the robot's power on, and check the cable and the rate of {baud} bits per second"
    )]
    Silent {
        /// The port.
        port: String,
        /// Bits per second.
        baud: u32,
    },
}
