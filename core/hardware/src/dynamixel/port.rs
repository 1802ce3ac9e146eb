//! Where the bytes go: a serial port, a pseudo-terminal, anything that can be read with a timeout.

use std::io::{self, Read, Write};
use std::path::Path;
use std::time::Duration;

use super::error::BusError;

/// A two-way stream of bytes whose reads give up after a while.
///
/// `read` returns what is there, at least one byte; without any byte for the set time it fails
/// with [`io::ErrorKind::TimedOut`]. Every other error, and an end of the stream, counts as a
/// port that vanished.
pub trait ServoPort: Read + Write + Send {
    /// Its name, for messages.
    fn name(&self) -> String;

    /// How long `read` waits for the first byte; zero asks only what is there.
    ///
    /// # Errors
    /// When the device is gone.
    fn set_read_timeout(&mut self, timeout: Duration) -> io::Result<()>;
}

struct SerialServoPort {
    name: String,
    port: Box<dyn serialport::SerialPort>,
    read_timeout: Duration,
}

/// Until another is set.
const READ_TIMEOUT: Duration = Duration::from_millis(2);

/// The longest packet lasts 2.6 ms on the wire; a port that takes no bytes for longer is gone.
const WRITE_TIMEOUT: Duration = Duration::from_millis(30);

impl Read for SerialServoPort {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.port.set_timeout(self.read_timeout)?;
        self.port.read(buffer)
    }
}

impl Write for SerialServoPort {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // One timeout serves both directions of the device.
        self.port.set_timeout(WRITE_TIMEOUT)?;
        self.port.write(bytes)
    }

    // Not `tcdrain`: it would wait for the wire, and reading the answer waits anyway.
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl ServoPort for SerialServoPort {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn set_read_timeout(&mut self, timeout: Duration) -> io::Result<()> {
        self.read_timeout = timeout;
        Ok(())
    }
}

/// Opens a serial port or a pseudo-terminal for this program alone.
///
/// # Errors
/// When there is none, it is used by another program, or may not be used.
pub fn open_port(path: &str, baud: u32) -> Result<Box<dyn ServoPort>, BusError> {
    match serialport::new(path, baud).timeout(READ_TIMEOUT).open() {
        Ok(port) => Ok(Box::new(SerialServoPort { name: path.to_owned(), port, read_timeout: READ_TIMEOUT })),
        Err(error) => Err(open_error(path, baud, &error)),
    }
}

fn open_error(path: &str, baud: u32, error: &serialport::Error) -> BusError {
    let port = path.to_owned();
    if cfg!(unix) && !Path::new(path).exists() {
        return BusError::NoSuchPort { port };
    }
    let detail = error.to_string();
    match error.kind() {
        serialport::ErrorKind::Io(io::ErrorKind::PermissionDenied) => BusError::NotAllowed { port },
        // The same kind stands for "in use" and "not there"; the path exists, so it is in use.
        serialport::ErrorKind::NoDevice => BusError::InUse { port },
        serialport::ErrorKind::InvalidInput => BusError::BaudRate { port, baud, detail },
        _ => BusError::CannotOpen { port, detail },
    }
}

/// A port of this machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PortInfo {
    /// To open it by.
    pub path: String,
    /// What is plugged in, as far as it tells.
    pub description: String,
    /// Whether it is a USB adapter.
    pub is_usb: bool,
    /// What makes it slower than it could be, and what to do.
    pub hint: Option<String>,
}

/// Serial ports of this machine, USB adapters first.
///
/// # Errors
/// When the system does not tell.
pub fn list_ports() -> Result<Vec<PortInfo>, BusError> {
    let ports =
        serialport::available_ports().map_err(|error| BusError::NoList { detail: error.to_string() })?;
    let mut ports: Vec<PortInfo> = ports.into_iter().map(port_info).collect();
    ports.sort_by_key(|port| (!port.is_usb, port.path.clone()));
    Ok(ports)
}

fn port_info(port: serialport::SerialPortInfo) -> PortInfo {
    let serialport::SerialPortType::UsbPort(usb) = &port.port_type else {
        let description = match port.port_type {
            serialport::SerialPortType::BluetoothPort => "Bluetooth",
            serialport::SerialPortType::PciPort => "built in",
            _ => "serial port",
        };
        return PortInfo {
            path: port.port_name,
            description: description.to_owned(),
            is_usb: false,
            hint: None,
        };
    };
    let told = [&usb.manufacturer, &usb.product, &usb.serial_number];
    let mut description = told.into_iter().flatten().cloned().collect::<Vec<_>>().join(" ");
    if description.is_empty() {
        description = format!("USB device {:04x}:{:04x}", usb.vid, usb.pid);
    }
    let hint = latency_hint(&port.port_name);
    PortInfo { path: port.port_name, description, is_usb: true, hint }
}

/// A USB adapter that collects bytes for longer than 1 ms before it hands them on slows every
/// answer down; `None` when it does not, or is no such adapter.
pub fn latency_hint(path: &str) -> Option<String> {
    latency_hint_in(Path::new("/sys/bus/usb-serial/devices"), path)
}

fn latency_hint_in(devices: &Path, path: &str) -> Option<String> {
    let device = Path::new(path).file_name()?;
    let file = devices.join(device).join("latency_timer");
    let latency_ms: u32 = std::fs::read_to_string(&file).ok()?.trim().parse().ok()?;
    (latency_ms > 1).then(|| {
        format!(
            "{path} holds answers back for up to {latency_ms} ms, which makes the bus slow: \
             run \"echo 1 | sudo tee {}\"",
            file.display()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_adapter_is_told_with_the_command_that_helps() {
        let devices = tempfile::tempdir().expect("a folder");
        let device = devices.path().join("ttyUSB7");
        std::fs::create_dir(&device).expect("a folder");
        std::fs::write(device.join("latency_timer"), "16\n").expect("a file");
        let hint = latency_hint_in(devices.path(), "/dev/ttyUSB7").expect("a hint");
        assert!(hint.contains("16 ms") && hint.contains("latency_timer"), "{hint}");
        std::fs::write(device.join("latency_timer"), "1\n").expect("a file");
        assert_eq!(latency_hint_in(devices.path(), "/dev/ttyUSB7"), None);
        assert_eq!(latency_hint_in(devices.path(), "/dev/ttyUSB8"), None);
    }

    #[test]
    fn a_port_that_is_not_there_is_told_so() {
        let error = open_port("/dev/no-such-port", 1_000_000).err().expect("it does not exist");
        assert!(matches!(error, BusError::NoSuchPort { .. }), "{error:?}");
        assert!(error.to_string().contains("/dev/no-such-port"), "{error}");
    }
}
