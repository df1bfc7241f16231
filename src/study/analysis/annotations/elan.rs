//! Annotations as a file of ELAN (EAF 3.0): a tier for each kind, films linked, raters' codes with a vocabulary.

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, BytesText, Event as XmlEvent};

use super::{CODES, RecordingAnnotations, on_one_line};

/// Comment by which a file is known that nobody has saved in ELAN since.
pub const UNTOUCHED: &str = " written by tomcom export ";
/// Property of the header with the name of the recording.
pub(super) const RECORDING: &str = "tomcom recording";
const VOCABULARY: &str = "causes";
const PLAIN: &str = "plain";
const CODED: &str = "coded";

type Attributes<'a> = &'a [(&'a str, &'a str)];

/// XML that is written to memory.
struct Xml(Writer<Vec<u8>>);

impl Xml {
    fn event(&mut self, event: XmlEvent) {
        self.0.write_event(event).expect("written to memory");
    }

    fn open(&mut self, name: &str, attributes: Attributes) {
        self.event(XmlEvent::Start(BytesStart::new(name).with_attributes(attributes.iter().copied())));
    }

    fn close(&mut self, name: &str) {
        self.event(XmlEvent::End(BytesEnd::new(name)));
    }

    fn empty(&mut self, name: &str, attributes: Attributes) {
        self.event(XmlEvent::Empty(BytesStart::new(name).with_attributes(attributes.iter().copied())));
    }

    /// An element with a text.
    fn text(&mut self, name: &str, attributes: Attributes, words: &str) {
        self.open(name, attributes);
        self.event(XmlEvent::Text(BytesText::new(&on_one_line(words))));
        self.close(name);
    }
}

/// The text of the file.
pub fn text(annotations: &RecordingAnnotations) -> String {
    let mut xml = Xml(Writer::new_with_indent(Vec::new(), b' ', 1));
    xml.event(XmlEvent::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)));
    xml.event(XmlEvent::Comment(BytesText::from_escaped(UNTOUCHED)));
    let date = annotations.started.as_deref().unwrap_or("1970-01-01T00:00:00Z");
    let root = [
        ("AUTHOR", "tomcom"),
        ("DATE", date),
        ("FORMAT", "3.0"),
        ("VERSION", "3.0"),
        ("xmlns:xsi", "http://www.w3.org/2001/XMLSchema-instance"),
        ("xsi:noNamespaceSchemaLocation", "http://www.mpi.nl/tools/elan/EAFv3.0.xsd"),
    ];
    xml.open("ANNOTATION_DOCUMENT", &root);
    header(&mut xml, annotations);
    tiers(&mut xml, annotations);
    types(&mut xml, annotations);
    xml.close("ANNOTATION_DOCUMENT");
    String::from_utf8_lossy(&xml.0.into_inner()).into_owned() + "\n"
}

fn header(xml: &mut Xml, annotations: &RecordingAnnotations) {
    xml.open("HEADER", &[("MEDIA_FILE", ""), ("TIME_UNITS", "milliseconds")]);
    for film in &annotations.films {
        let origin = ((film.ahead_s * 1e3).round() as u64).to_string();
        let url = file_url(&film.path);
        let mut attributes = vec![("MEDIA_URL", url.as_str()), ("MIME_TYPE", mime_type(&film.path))];
        attributes.extend((origin != "0").then_some(("TIME_ORIGIN", origin.as_str())));
        xml.empty("MEDIA_DESCRIPTOR", &attributes);
    }
    let number: usize = annotations.tiers.iter().map(|tier| tier.annotations.len()).sum();
    xml.text("PROPERTY", &[("NAME", RECORDING)], &annotations.recording);
    xml.text("PROPERTY", &[("NAME", "lastUsedAnnotationId")], &number.to_string());
    xml.close("HEADER");
}

fn tiers(xml: &mut Xml, annotations: &RecordingAnnotations) {
    let placed: Vec<_> = annotations.tiers.iter().map(|tier| (tier, tier.separate_ms())).collect();
    xml.open("TIME_ORDER", &[]);
    let times = placed.iter().flat_map(|(_, placed)| placed).flat_map(|(begin, end, _)| [begin, end]);
    for (index, time) in times.enumerate() {
        let (id, value) = (format!("ts{}", index + 1), time.to_string());
        xml.empty("TIME_SLOT", &[("TIME_SLOT_ID", &id), ("TIME_VALUE", &value)]);
    }
    xml.close("TIME_ORDER");
    let mut number = 0;
    for (tier, placed) in &placed {
        let kind = if tier.name.starts_with(CODES) { CODED } else { PLAIN };
        xml.open("TIER", &[("LINGUISTIC_TYPE_REF", kind), ("TIER_ID", &tier.name)]);
        for (_, _, words) in placed {
            number += 1;
            let (id, first, last) =
                (format!("a{number}"), format!("ts{}", 2 * number - 1), format!("ts{}", 2 * number));
            xml.open("ANNOTATION", &[]);
            let attributes = [("ANNOTATION_ID", id.as_str()), ("TIME_SLOT_REF1", &first), ("TIME_SLOT_REF2", &last)];
            xml.open("ALIGNABLE_ANNOTATION", &attributes);
            xml.text("ANNOTATION_VALUE", &[], words);
            xml.close("ALIGNABLE_ANNOTATION");
            xml.close("ANNOTATION");
        }
        xml.close("TIER");
    }
}

fn types(xml: &mut Xml, annotations: &RecordingAnnotations) {
    let of = |name| ("LINGUISTIC_TYPE_ID", name);
    let common = [("GRAPHIC_REFERENCES", "false"), ("TIME_ALIGNABLE", "true")];
    xml.empty("LINGUISTIC_TYPE", &[common[0], of(PLAIN), common[1]]);
    xml.empty("LINGUISTIC_TYPE", &[("CONTROLLED_VOCABULARY_REF", VOCABULARY), common[0], of(CODED), common[1]]);
    let english =
        [("LANG_DEF", "http://cdb.iso.org/lg/CDB-00138502-001"), ("LANG_ID", "eng"), ("LANG_LABEL", "English (eng)")];
    xml.empty("LANGUAGE", &english);
    xml.open("CONTROLLED_VOCABULARY", &[("CV_ID", VOCABULARY)]);
    xml.text("DESCRIPTION", &[("LANG_REF", "eng")], "causes of errors, as raters code them");
    for (index, words) in annotations.code_words.iter().enumerate() {
        let id = format!("cause{}", index + 1);
        xml.open("CV_ENTRY_ML", &[("CVE_ID", &id)]);
        xml.text("CVE_VALUE", &[("DESCRIPTION", ""), ("LANG_REF", "eng")], words);
        xml.close("CV_ENTRY_ML");
    }
    xml.close("CONTROLLED_VOCABULARY");
}

/// The address of a file: what is not plain is written as `%` and two hexadecimal digits.
fn file_url(path: &str) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"/-_.~:".contains(&byte);
    let path = path.replace('\\', "/");
    let escaped =
        path.bytes().map(|byte| if plain(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") });
    format!("file://{}{}", if path.starts_with('/') { "" } else { "/" }, escaped.collect::<String>())
}

fn mime_type(path: &str) -> &'static str {
    match path.rsplit('.').next().unwrap_or_default().to_ascii_lowercase().as_str() {
        "mp4" | "m4v" => "video/mp4",
        "mov" => "video/quicktime",
        "mpg" | "mpeg" => "video/mpeg",
        _ => "video/*",
    }
}
