//! Interface to liblsl, the library of the Lab Streaming Layer, which is loaded when a session asks for LSL. This
//! module wraps the library's functions and objects in values that are safe to use. It is the only file of the crate
//! with code whose safety the compiler cannot check.

use std::error::Error;
use std::ffi::{CStr, CString, c_char, c_void};
use std::path::Path;

use libloading::Library;

use super::configuration::LslError;
use crate::lsl::{MetadataNode, StreamDescription};

/// Pointer to an object of liblsl, or to an element of its metadata.
type Pointer = *mut c_void;

/// File names of liblsl on this operating system.
#[cfg(target_os = "macos")]
const SYSTEM_NAMES: [&str; 2] = ["liblsl.dylib", "/opt/homebrew/lib/liblsl.dylib"];
#[cfg(windows)]
const SYSTEM_NAMES: [&str; 1] = ["lsl.dll"];
#[cfg(not(any(target_os = "macos", windows)))]
const SYSTEM_NAMES: [&str; 2] = ["liblsl.so.2", "liblsl.so"];

/// Numeric codes for formats of channels (liblsl's `lsl_channel_format_t`).
const DOUBLE: i32 = 2;
const STRING: i32 = 3;
/// Sampling rate that marks a stream as irregular (`LSL_IRREGULAR_RATE`).
const IRREGULAR: f64 = 0.0;
/// Buffer sizes: samples that an outlet keeps for a slow consumer, in hundreds, and samples that an inlet keeps for
/// this program, in seconds.
const KEPT_OUT: i32 = 360;
const KEPT_IN: i32 = 10;
/// Time after which a stream that does not answer any more is forgotten, in seconds.
const FORGET_S: f64 = 3.0;
/// Largest number of LSL streams that one search can find.
pub(super) const MOST_FOUND: u16 = 32;
/// Error that a function of liblsl returns on a time-out (`lsl_timeout_error`).
const TIMEOUT: i32 = -1;

macro_rules! functions {
    ($($name:ident: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// The functions of liblsl that are used, with the signatures of the library's header files
        /// (`include/lsl/*.h`).
        #[derive(Debug)]
        struct Functions { $($name: unsafe extern "C" fn($($argument),*) $(-> $result)?,)* }

        impl Functions {
            fn find(library: &Library, place: &str) -> Result<Functions, LslError> {
                Ok(Functions { $($name: {
                    let symbol = concat!("lsl_", stringify!($name));
                    // SAFETY: the signatures are those of liblsl's header files, which have not changed since version
                    // 1.13.
                    let found = unsafe { library.get::<unsafe extern "C" fn($($argument),*) $(-> $result)?>(symbol) };
                    *found.map_err(|_| LslError::Unfit { place: place.to_string(), lacks: symbol })?
                },)* })
            }
        }
    };
}

functions! {
    library_version: fn() -> i32;
    set_config_content: fn(*const c_char);
    local_clock: fn() -> f64;
    create_streaminfo: fn(*const c_char, *const c_char, i32, f64, i32, *const c_char) -> Pointer;
    destroy_streaminfo: fn(Pointer);
    get_name: fn(Pointer) -> *const c_char;
    get_type: fn(Pointer) -> *const c_char;
    get_hostname: fn(Pointer) -> *const c_char;
    get_source_id: fn(Pointer) -> *const c_char;
    get_channel_count: fn(Pointer) -> i32;
    get_channel_format: fn(Pointer) -> i32;
    get_desc: fn(Pointer) -> Pointer;
    append_child: fn(Pointer, *const c_char) -> Pointer;
    append_child_value: fn(Pointer, *const c_char, *const c_char) -> Pointer;
    child: fn(Pointer, *const c_char) -> Pointer;
    next_sibling_n: fn(Pointer, *const c_char) -> Pointer;
    child_value_n: fn(Pointer, *const c_char) -> *const c_char;
    create_outlet: fn(Pointer, i32, i32) -> Pointer;
    destroy_outlet: fn(Pointer);
    push_sample_dt: fn(Pointer, *const f64, f64) -> i32;
    push_sample_strt: fn(Pointer, *const *const c_char, f64) -> i32;
    have_consumers: fn(Pointer) -> i32;
    resolve_bypred: fn(*mut Pointer, u32, *const c_char, i32, f64) -> i32;
    create_continuous_resolver_bypred: fn(*const c_char, f64) -> Pointer;
    resolver_results: fn(Pointer, *mut Pointer, u32) -> i32;
    destroy_continuous_resolver: fn(Pointer);
    create_inlet: fn(Pointer, i32, i32, i32) -> Pointer;
    destroy_inlet: fn(Pointer);
    get_fullinfo: fn(Pointer, f64, *mut i32) -> Pointer;
    open_stream: fn(Pointer, f64, *mut i32);
    time_correction: fn(Pointer, f64, *mut i32) -> f64;
    inlet_flush: fn(Pointer) -> u32;
    pull_sample_d: fn(Pointer, *mut f64, i32, f64, *mut i32) -> f64;
}

/// The loaded library liblsl. The library stays loaded until the program ends, since its own threads may still run.
#[derive(Clone, Copy, Debug)]
pub struct LslLibrary {
    functions: &'static Functions,
    /// Version of the LSL library, multiplied by 100.
    pub version: i32,
}

impl LslLibrary {
    /// Loads liblsl from this path, or the installed library, and passes it this configuration.
    ///
    /// # Errors
    /// The library is missing, or lacks a required function.
    pub fn load(path: Option<&Path>, configuration: &str) -> Result<LslLibrary, LslError> {
        let (library, place) = match path {
            Some(path) => (open(path)?, path.display().to_string()),
            None => {
                let mut tried = SYSTEM_NAMES.iter().map(|name| Ok((open(Path::new(name))?, (*name).to_string())));
                let first = tried.next().unwrap_or(Err(LslError::Missing(String::new())));
                first.or_else(|error| tried.find_map(Result::ok).ok_or(error))?
            }
        };
        let functions: &'static Functions = Box::leak(Box::new(Functions::find(&library, &place)?));
        std::mem::forget(library);
        let configuration = text(configuration);
        // SAFETY: the text ends with a zero byte and lives until the call returns; the library copies it.
        unsafe { (functions.set_config_content)(configuration.as_ptr()) };
        // SAFETY: the function takes no arguments and only returns a number.
        let version = unsafe { (functions.library_version)() };
        Ok(LslLibrary { functions, version })
    }

    /// Time of LSL's clock on this computer, in seconds.
    pub fn local_clock(&self) -> f64 {
        // SAFETY: the function takes no arguments and reads a clock.
        unsafe { (self.functions.local_clock)() }
    }

    /// Starts to offer an LSL stream to other programs.
    ///
    /// # Errors
    /// The LSL library refuses the stream.
    pub fn offer(&self, stream: &StreamDescription) -> Result<LslOutletHandle, LslError> {
        let functions = self.functions;
        let (name, content, source) = (text(&stream.name), text(stream.content), text(&stream.source));
        let format = if stream.is_text { STRING } else { DOUBLE };
        let channels = stream.channels.len();
        let refused = || LslError::Refused(stream.name.clone());
        let count = i32::try_from(channels).map_err(|_| refused())?;
        // SAFETY: all texts end with a zero byte and live until the calls return; `info` is destroyed once, and the
        // outlet has its own copy of it. If the library cannot make an object it returns null, which is not used any
        // further.
        let pointer = unsafe {
            let info = (functions.create_streaminfo)(
                name.as_ptr(),
                content.as_ptr(),
                count,
                IRREGULAR,
                format,
                source.as_ptr(),
            );
            if info.is_null() {
                return Err(refused());
            }
            let root = (functions.get_desc)(info);
            stream.metadata().iter().for_each(|node| functions.append(root, node));
            let outlet = (functions.create_outlet)(info, 0, KEPT_OUT);
            (functions.destroy_streaminfo)(info);
            outlet
        };
        if pointer.is_null() { Err(refused()) } else { Ok(LslOutletHandle { functions, pointer, channels }) }
    }

    /// Streams that satisfy a predicate (an XPath 1.0 expression); waits for `wanted` streams, but not longer than
    /// `patience_s` seconds.
    pub fn resolve(&self, predicate: &str, wanted: u16, patience_s: f64) -> Vec<DiscoveredLslStream> {
        let (predicate, mut found) = (text(predicate), vec![std::ptr::null_mut(); usize::from(MOST_FOUND)]);
        // SAFETY: the buffer has room for as many pointers as the library is told.
        let count = unsafe {
            let (buffer, room) = (found.as_mut_ptr(), u32::from(MOST_FOUND));
            (self.functions.resolve_bypred)(buffer, room, predicate.as_ptr(), i32::from(wanted), patience_s)
        };
        self.functions.discovered(found, count)
    }

    /// Goes on looking for streams that satisfy a predicate; `None` if the library cannot.
    pub fn watch(&self, predicate: &str) -> Option<LslStreamWatch> {
        let predicate = text(predicate);
        // SAFETY: the text ends with a zero byte and lives until the call returns; the library copies it.
        let pointer = unsafe { (self.functions.create_continuous_resolver_bypred)(predicate.as_ptr(), FORGET_S) };
        (!pointer.is_null()).then_some(LslStreamWatch { functions: self.functions, pointer })
    }
}

/// A search for LSL streams that goes on until this value is dropped. The value stays on the thread that created it.
#[derive(Debug)]
pub struct LslStreamWatch {
    functions: &'static Functions,
    pointer: Pointer,
}

impl LslStreamWatch {
    /// The streams that there are now.
    pub fn streams(&self) -> Vec<DiscoveredLslStream> {
        let mut found = vec![std::ptr::null_mut(); usize::from(MOST_FOUND)];
        // SAFETY: the resolver exists as long as this value, and the buffer has room for as many pointers as the library
        // is told.
        let count =
            unsafe { (self.functions.resolver_results)(self.pointer, found.as_mut_ptr(), u32::from(MOST_FOUND)) };
        self.functions.discovered(found, count)
    }
}

impl Drop for LslStreamWatch {
    fn drop(&mut self) {
        // SAFETY: the resolver is destroyed once.
        unsafe { (self.functions.destroy_continuous_resolver)(self.pointer) };
    }
}

fn open(path: &Path) -> Result<Library, LslError> {
    // The operating system would wait for whoever writes to a pipe. It looks for a bare name itself.
    if path.components().count() > 1 && std::fs::metadata(path).is_ok_and(|found| !found.is_file()) {
        return Err(LslError::Missing(format!(
            "{}: it is no regular file, but a pipe, device or folder",
            path.display()
        )));
    }
    // SAFETY: loading a library runs its initialisers; the session file, or the operating system, names this one as
    // liblsl.
    unsafe { Library::new(path) }.map_err(|error| {
        // The outer error only names the function of the operating system that failed.
        let reason = error.source().map_or(error.to_string(), ToString::to_string);
        let place = path.display().to_string();
        LslError::Missing(if reason.contains(&place) { reason } else { format!("{place}: {reason}") })
    })
}

/// A text for the LSL library; the text ends at its first zero byte (this program's texts contain none).
fn text(text: &str) -> CString {
    let bytes: Vec<u8> = text.bytes().take_while(|byte| *byte != 0).collect();
    CString::new(bytes).unwrap_or_default()
}

impl Functions {
    /// The stream descriptions that the library wrote into this buffer, as many as `count`.
    fn discovered(&'static self, mut buffer: Vec<Pointer>, count: i32) -> Vec<DiscoveredLslStream> {
        buffer.truncate(usize::try_from(count).unwrap_or(0));
        buffer.into_iter().map(|info| DiscoveredLslStream { functions: self, info }).collect()
    }

    /// Adds an element to an element of a stream's metadata.
    ///
    /// # Safety
    /// `parent` is an element of a stream description that exists.
    unsafe fn append(&self, parent: Pointer, node: &MetadataNode) {
        let (name, content) = (text(node.name), text(&node.text));
        // SAFETY: texts live until the calls return; elements belong to the description, which the caller keeps.
        unsafe {
            if node.inside.is_empty() {
                (self.append_child_value)(parent, name.as_ptr(), content.as_ptr());
            } else {
                let element = (self.append_child)(parent, name.as_ptr());
                node.inside.iter().for_each(|inner| self.append(element, inner));
            }
        }
    }

    /// Copies a text of the LSL library, which exists as long as the object to which the text belongs.
    ///
    /// # Safety
    /// `from` is null or a text that ends with a zero byte.
    unsafe fn read(from: *const c_char) -> String {
        // SAFETY: the caller guarantees that `from` is null or a valid text.
        if from.is_null() { String::new() } else { unsafe { CStr::from_ptr(from) }.to_string_lossy().into_owned() }
    }
}

/// An outgoing LSL stream, offered until this value is dropped. The value stays on the thread that created it.
#[derive(Debug)]
pub struct LslOutletHandle {
    functions: &'static Functions,
    pointer: Pointer,
    channels: usize,
}

impl LslOutletHandle {
    /// Sends a sample of numbers, stamped with `time_s` of LSL's clock; returns whether the library accepted the
    /// sample.
    pub fn push_numbers(&self, values: &[f64], time_s: f64) -> bool {
        // SAFETY: there is a value for every channel, and the outlet has numbers of this type.
        values.len() == self.channels
            && unsafe { (self.functions.push_sample_dt)(self.pointer, values.as_ptr(), time_s) } == 0
    }

    /// Sends a sample of texts, stamped with `time_s` of LSL's clock; returns whether the library accepted the sample.
    pub fn push_texts(&self, values: &[String], time_s: f64) -> bool {
        let texts: Vec<CString> = values.iter().map(|value| text(value)).collect();
        let pointers: Vec<*const c_char> = texts.iter().map(|text| text.as_ptr()).collect();
        // SAFETY: there is a text for every channel; each lives until the call returns, and the library copies it.
        pointers.len() == self.channels
            && unsafe { (self.functions.push_sample_strt)(self.pointer, pointers.as_ptr(), time_s) } == 0
    }

    pub fn has_consumers(&self) -> bool {
        // SAFETY: the outlet exists as long as this value.
        unsafe { (self.functions.have_consumers)(self.pointer) != 0 }
    }
}

impl Drop for LslOutletHandle {
    fn drop(&mut self) {
        // SAFETY: the outlet is destroyed once.
        unsafe { (self.functions.destroy_outlet)(self.pointer) };
    }
}

/// An LSL stream that another program offers, found by a search.
#[derive(Debug)]
pub struct DiscoveredLslStream {
    functions: &'static Functions,
    info: Pointer,
}

impl DiscoveredLslStream {
    fn text(&self, get: unsafe extern "C" fn(Pointer) -> *const c_char) -> String {
        // SAFETY: the description exists as long as this value, and its text with it; the text is copied.
        unsafe { Functions::read(get(self.info)) }
    }

    pub fn identity(&self) -> [String; 3] {
        let functions = self.functions;
        [functions.get_name, functions.get_type, functions.get_hostname].map(|get| self.text(get))
    }

    /// The source of the stream, which the sender names: a device or a program.
    pub fn source(&self) -> String {
        self.text(self.functions.get_source_id)
    }

    pub fn is_text(&self) -> bool {
        // SAFETY: the description exists as long as this value.
        unsafe { (self.functions.get_channel_format)(self.info) == STRING }
    }

    pub fn channel_count(&self) -> usize {
        // SAFETY: the description exists as long as this value.
        usize::try_from(unsafe { (self.functions.get_channel_count)(self.info) }).unwrap_or(0)
    }

    /// Connects to the stream; `None` if the stream no longer exists or does not answer in time.
    pub fn connect(&self, patience_s: f64) -> Option<LslInletHandle> {
        let channels = self.channel_count();
        // SAFETY: the description exists; the inlet has its own copy of it. Without recovery, the library reports a
        // lost stream as lost.
        let pointer = unsafe { (self.functions.create_inlet)(self.info, KEPT_IN, 0, 0) };
        if pointer.is_null() {
            return None;
        }
        let inlet = LslInletHandle { functions: self.functions, pointer, channels };
        let mut error = 0;
        // SAFETY: the inlet exists, and the error is written before the call returns.
        unsafe { (self.functions.open_stream)(inlet.pointer, patience_s, &raw mut error) };
        (error == 0).then_some(inlet)
    }
}

impl Drop for DiscoveredLslStream {
    fn drop(&mut self) {
        // SAFETY: the description is destroyed once.
        unsafe { (self.functions.destroy_streaminfo)(self.info) };
    }
}

/// Error: the stream was lost, or the library no longer reads it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LslStreamLost;

/// An incoming LSL stream, read until this value is dropped. The value stays on the thread that created it.
#[derive(Debug)]
pub struct LslInletHandle {
    functions: &'static Functions,
    pointer: Pointer,
    channels: usize,
}

impl LslInletHandle {
    /// Labels of the channels, as far as the stream's metadata name labels; `None` if the metadata do not arrive in
    /// time.
    pub fn labels(&self, patience_s: f64) -> Option<Vec<String>> {
        let (functions, mut error) = (self.functions, 0);
        // SAFETY: the inlet exists; the description that it returns belongs to this function and is destroyed once.
        // Missing elements are null or empty, which the library accepts as well; there are no more steps than channels.
        unsafe {
            let info = (functions.get_fullinfo)(self.pointer, patience_s, &raw mut error);
            if info.is_null() {
                return None;
            }
            let channels = (functions.child)((functions.get_desc)(info), c"channels".as_ptr());
            let mut channel = (functions.child)(channels, c"channel".as_ptr());
            let mut labels = Vec::new();
            for _ in 0..self.channels {
                labels.push(Functions::read((functions.child_value_n)(channel, c"label".as_ptr())));
                channel = (functions.next_sibling_n)(channel, c"channel".as_ptr());
            }
            (functions.destroy_streaminfo)(info);
            Some(labels)
        }
    }

    /// Correction in seconds that, added to the stream's times, gives times of this computer's LSL clock; `None` while
    /// unknown.
    pub fn time_correction(&self, patience_s: f64) -> Option<f64> {
        let mut error = 0;
        // SAFETY: the inlet exists, and the error is written before the call returns.
        let correction = unsafe { (self.functions.time_correction)(self.pointer, patience_s, &raw mut error) };
        (error == 0).then_some(correction)
    }

    /// Drops the samples that have arrived and were not read.
    pub fn flush(&self) {
        // SAFETY: the inlet exists as long as this value.
        unsafe { (self.functions.inlet_flush)(self.pointer) };
    }

    /// Reads the next sample into `values` and returns its time on the stream's clock; `None` if no sample arrives in
    /// time.
    ///
    /// # Errors
    /// The stream is lost.
    pub fn pull(&self, values: &mut Vec<f64>, patience_s: f64) -> Result<Option<f64>, LslStreamLost> {
        values.resize(self.channels, 0.0);
        let mut error = 0;
        // SAFETY: the buffer has room for a value of each channel.
        let time = unsafe {
            let room = self.channels as i32;
            (self.functions.pull_sample_d)(self.pointer, values.as_mut_ptr(), room, patience_s, &raw mut error)
        };
        match error {
            0 | TIMEOUT => Ok((time != 0.0).then_some(time)),
            _ => Err(LslStreamLost),
        }
    }
}

impl Drop for LslInletHandle {
    fn drop(&mut self) {
        // SAFETY: the inlet is destroyed once.
        unsafe { (self.functions.destroy_inlet)(self.pointer) };
    }
}
