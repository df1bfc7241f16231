//! The simulated controller of a UR5, in its own time: what goes over RTDE byte by byte, the dashboard's commands, scripts;
//! and the driver of a real UR5 against it (`driver`).
//!
//! The full experiments (`cargo test --release -p tomcom-devices --test devices -- --ignored --nocapture`) do what the short ones do, more often.

mod driver;

use std::net::{IpAddr, Ipv4Addr};
use std::path::Path;
use std::sync::LazyLock;
use std::time::Duration;

use tokio::io::{AsyncBufReadExt, AsyncReadExt, AsyncWriteExt, BufReader};
use tokio::net::TcpStream;
use tokio::sync::mpsc;
use tomcom_arm::physics::CYCLE_S;
use tomcom_core::kitchen::Kitchen;
use tomcom_core::robot::SafetyMode;
use tomcom_devices::ur::controller::{ProgramState, RobotMode, Series, SimulatedController};
use tomcom_devices::ur::dashboard::answer;
use tomcom_devices::ur::faults::Fault;
use tomcom_devices::ur::rtde::{RtdeConnection, RtdeFault, package};
use tomcom_devices::ur::script::{Script, ScriptGatherer};
use tomcom_devices::ur::server::ControllerServer;
use tomcom_devices::ur::variables::Datum;
use tomcom_session::files::read_kitchen;

fn kitchen() -> Kitchen {
    let layout = concat!(env!("CARGO_MANIFEST_DIR"), "/../../layouts/sushi.toml");
    read_kitchen(Path::new(layout)).expect("the kitchen loads").kitchen
}

/// Building one takes a while, as its arm settles.
static OFF: LazyLock<SimulatedController> = LazyLock::new(|| SimulatedController::new(&kitchen(), Series::Cb3));
static RUNNING: LazyLock<SimulatedController> = LazyLock::new(|| {
    let mut controller = OFF.clone();
    assert_eq!(answer("brake release", &mut controller).as_deref(), Some("Brake releasing"));
    run(&mut controller, 2.1);
    assert_eq!(controller.mode(), RobotMode::Running);
    controller
});

fn run(controller: &mut SimulatedController, seconds: f64) {
    for _ in 0..(seconds / CYCLE_S).round() as usize {
        controller.cycle();
    }
}

fn messages(controller: &mut SimulatedController) -> Vec<String> {
    controller.take_messages().into_iter().map(|message| message.text).collect()
}

/// Names after a frequency, as a client asks for outputs.
fn outputs(hertz: f64, names: &str) -> Vec<u8> {
    package(b'O', &[&hertz.to_be_bytes(), names.as_bytes()].concat())
}

/// The answers as the tests of the manufacturer's client library have them (there the length of the answer to O is wrong).
#[test]
fn a_handshake_is_answered_as_by_a_real_controller() {
    let mut controller = OFF.clone();
    let mut client = RtdeConnection::new(1);
    let mut check = |question: &[u8], expected: &[u8]| {
        assert_eq!(client.take(question, &mut controller).expect("an answer"), expected, "{question:?}");
    };
    check(&[0, 5, b'V', 0, 2], &[0x00, 0x04, 0x56, 0x01]);
    check(&package(b'I', b"speed_slider_mask,speed_slider_fraction"), b"\x00\x11I\x01UINT32,DOUBLE");
    check(&outputs(125.0, "timestamp,target_q"), b"\x00\x13O\x01DOUBLE,VECTOR6D");
    check(&[0, 3, b'S'], &[0x00, 0x04, 0x53, 0x01]);
    check(&[0, 3, b'P'], &[0x00, 0x04, 0x50, 0x01]);
    // Not from there: what cannot be had has no recipe, and is named.
    check(&outputs(125.0, "timestamp,target_qq,"), b"\x00\x14O\x00DOUBLE,NOT_FOUND");
    check(&package(b'v', b""), &[0, 19, b'v', 0, 0, 0, 3, 0, 0, 0, 15, 0, 0, 0, 8, 0, 1, 159, 99]);
    let mut other = RtdeConnection::new(2);
    other.take(&[0, 5, b'V', 0, 2], &mut controller).expect("an answer");
    let asked = package(b'I', b"speed_slider_mask");
    assert_eq!(other.take(&asked, &mut controller), Ok(b"\x00\x0aI\x00IN_USE".to_vec()));
    client.leave(&mut controller);
    assert_eq!(other.take(&asked, &mut controller), Ok(b"\x00\x0aI\x01UINT32".to_vec()));
}

#[test]
fn the_same_bytes_in_other_pieces_have_the_same_answers() {
    let mut whole = vec![0, 5, b'V', 0, 2];
    whole.extend(outputs(125.0, "actual_q,output_int_register_3,safety_status_bits"));
    whole.extend(package(b'I', b"input_int_register_24"));
    whole.extend(package(b'U', &[1, 0, 0, 0, 9]));
    whole.extend([0, 3, b'S']);
    let (mut one, mut two) = (OFF.clone(), OFF.clone());
    let expected = RtdeConnection::new(1).take(&whole, &mut one).expect("answers");
    let mut client = RtdeConnection::new(1);
    let pieces = whole.iter().flat_map(|byte| client.take(&[*byte], &mut two).expect("answers"));
    assert_eq!(pieces.collect::<Vec<_>>(), expected);
    assert_eq!((one.inputs.integers[24], two.inputs.integers[24]), (9, 9));
}

#[test]
fn every_type_comes_back_as_it_was_written() {
    let all = [
        Datum::Bool(true),
        Datum::Uint8(200),
        Datum::Uint32(u32::MAX - 1),
        Datum::Uint64(1 << 40),
        Datum::Int32(-5),
        Datum::Double(-0.1),
        Datum::Vector3d([0.1, -2.0, 3e9]),
        Datum::Vector6d([1.0, 2.0, 3.0, 4.0, 5.0, -6.5]),
        Datum::Vector6int32([253, -1, 0, 7, i32::MIN, i32::MAX]),
    ];
    for datum in all {
        let mut bytes = Vec::new();
        datum.write(&mut bytes);
        assert_eq!(datum.read(&mut &bytes[..]), Some(datum));
        assert_eq!(datum.read(&mut &bytes[1..]), None, "{datum:?}");
    }
    // A package of a real controller: timestamp and target_speed_fraction.
    let recorded = [0x40, 0xd0, 0x07, 0x0d, 0x2f, 0x1a, 0x9f, 0xbe, 0x3f, 0xf0, 0, 0, 0, 0, 0, 0];
    let mut rest = &recorded[..];
    assert_eq!(Datum::Double(0.0).read(&mut rest), Some(Datum::Double(16412.206)));
    assert_eq!(Datum::Double(0.0).read(&mut rest), Some(Datum::Double(1.0)));
}

#[test]
fn what_is_no_package_ends_the_connection() {
    let check = |bytes: &[u8], expected: RtdeFault| {
        let mut client = RtdeConnection::new(1);
        assert_eq!(client.take(bytes, &mut OFF.clone()), Err(expected));
    };
    let agreed = |bytes: &[u8]| [&[0, 5, b'V', 0, 2], bytes].concat();
    check(&[0, 2, b'V'], RtdeFault::Length(2));
    check(&[0, 4, b'V', 2], RtdeFault::Content('V'));
    check(&outputs(125.0, "timestamp"), RtdeFault::Version('O'));
    check(&agreed(&[0, 3, b'X']), RtdeFault::Kind('X'));
    check(&agreed(&[0, 4, b'O', 1]), RtdeFault::Content('O'));
    check(&agreed(&[0, 5, b'U', 1, 1]), RtdeFault::Content('U'));
    let short = [package(b'I', b"input_int_register_24"), package(b'U', &[1, 0, 0])].concat();
    check(&agreed(&short), RtdeFault::Content('U'));
}

#[test]
fn outputs_come_as_often_as_asked() {
    let count = |series, hertz| {
        let mut controller = OFF.clone();
        controller.series = series;
        let mut client = RtdeConnection::new(1);
        let setup = [vec![0, 5, b'V', 0, 2], outputs(hertz, "timestamp"), vec![0, 3, b'S']].concat();
        client.take(&setup, &mut controller).expect("answers");
        let mut bytes = 0;
        for _ in 0..125 {
            controller.cycle();
            bytes += (1..=4).map(|part| client.outputs(&controller, f64::from(part) / 4.0).len()).sum::<usize>();
        }
        bytes / 12
    };
    // The first comes at once.
    assert!((125..=126).contains(&count(Series::Cb3, 125.0)));
    assert!((500..=501).contains(&count(Series::E, 500.0)));
    assert!((125..=126).contains(&count(Series::Cb3, 500.0)));
    assert!((9..=11).contains(&count(Series::E, 10.0)));
}

#[test]
fn the_dashboard_switches_power_and_tells_the_state() {
    let mut controller = OFF.clone();
    let ask = |command: &str, controller: &mut SimulatedController| answer(command, controller).unwrap_or_default();
    assert_eq!(ask("robotmode", &mut controller), "Robotmode: POWER_OFF");
    assert_eq!(ask("play", &mut controller), "Failed to execute: play");
    assert_eq!(ask("power on\r", &mut controller), "Powering on");
    run(&mut controller, 1.1);
    assert_eq!(ask("robotmode", &mut controller), "Robotmode: IDLE");
    assert_eq!(ask("brake release", &mut controller), "Brake releasing");
    run(&mut controller, 1.1);
    assert_eq!(ask("robotmode", &mut controller), "Robotmode: RUNNING");
    assert_eq!(ask("load other.urp", &mut controller), "File not found: other.urp");
    controller.add_program("hold.script", "def hold():\n  while True:\n    sync()\n  end\nend\n");
    assert_eq!(ask("load hold.urp", &mut controller), "Loading program: hold.urp");
    assert_eq!(ask("play", &mut controller), "Starting program");
    assert_eq!(ask("programState", &mut controller), "PLAYING hold");
    assert_eq!(ask("pause", &mut controller), "Pausing program");
    assert_eq!(ask("programState", &mut controller), "PAUSED hold");
    Fault::ProtectiveStop.happen(&mut controller);
    assert_eq!(ask("safetystatus", &mut controller), "Safetystatus: PROTECTIVE_STOP");
    assert!(ask("unlock protective stop", &mut controller).starts_with("Cannot unlock protective stop until 5s"));
    run(&mut controller, 5.1);
    assert_eq!(ask("unlock protective stop", &mut controller), "Protective stop releasing");
    assert_eq!(ask("play", &mut controller), "Starting program");
    assert_eq!(ask("stop", &mut controller), "Stopped");
    assert_eq!(ask("running", &mut controller), "Program running: false");
    Fault::EmergencyStop.happen(&mut controller);
    run(&mut controller, 0.1);
    assert_eq!(ask("safetymode", &mut controller), "Safetymode: ROBOT_EMERGENCY_STOP");
    assert_eq!(ask("robotmode", &mut controller), "Robotmode: POWER_OFF");
    Fault::Reset.happen(&mut controller);
    assert_eq!(ask("safetymode", &mut controller), "Safetymode: NORMAL");
    assert_eq!(ask("open", &mut controller), "could not understand: 'open'");
    assert_eq!(answer("quit", &mut controller), None);
}

#[test]
fn a_script_computes() {
    let mut controller = RUNNING.clone();
    let script = "def sums():\n  # A comment.\n  def add(a, b=2):\n    return a + b\n  end\n  global total = 0\n  i = 0\n  \
                  while i < 10:\n    i = i + 1\n    if i % 2 == 0 and not (i == 4):\n      continue\n    elif i > 7:\n      \
                  break\n    end\n    total = total + i\n  end\n  list = [1, 2.5,\n    -3e0]\n  list[1] = total\n  pose = \
                  p[0.1, 0, 0, 0, 0, 3]\n  pose[0] = pose[0] * 2\n  three = add(1)\n  textmsg(\"sums \", list)\n  \
                  textmsg(three, pose[0] == 0.2)\nend\n";
    assert!(controller.run_script(script));
    controller.cycle();
    assert_eq!(messages(&mut controller), ["sums [1, 20, -3]", "3True"]);
    assert_eq!(controller.state(), ProgramState::Stopped);
}

#[test]
fn what_is_wrong_with_a_script_is_told_with_its_line() {
    let check = |script: &str, expected: &str| {
        let error = Script::read(script).expect_err("it cannot be read");
        assert_eq!(error.to_string(), expected);
    };
    check("def a():\n  x = \nend\n", "line 2: found the end of the line where a value is expected");
    check("def a():\n  thread b():\n  end\nend\n", "line 2: thread is not supported");
    check("movej([0, 1], a=1", "line 1: found the end of the line where ) is expected");
    check("x = p[1, 2]\n", "line 1: a pose with 2 numbers; it has 6");
    check("x = \"never\n", "line 1: a text that does not end");
    check(&format!("x = {}1{}\n", "(".repeat(100), ")".repeat(100)), "line 1: more than 64 levels");
    let fails = |script: &str, expected: &str| {
        let mut controller = RUNNING.clone();
        assert!(controller.run_script(script));
        run(&mut controller, 0.2);
        assert!(messages(&mut controller)[0].contains(expected), "{script}");
        assert_eq!(controller.state(), ProgramState::Stopped);
    };
    fails("def a():\n  sync()\n  x = y\nend\n", "line 3: no variable y");
    fails("def a():\n  movec(1)\nend\n", "line 2: no function movec, or none that is supported");
    fails("def a():\n  while True:\n    x = 1\n  end\nend\n", "none that takes time");
    fails("def a():\n  a()\nend\n", "calls inside one another");
    fails(
        "def a():\n  x = [1]\n  while True:\n    x = [x, x]\n    sync()\n  end\nend\n",
        "x would have more than 1000 items",
    );
    fails("stopj(sqrt(-1))\n", "a is NaN; it is a number");
    fails("rtde_set_watchdog(\"output_int_register_1\", 10)\n", "is no input variable");
    let mut gatherer = ScriptGatherer::default();
    assert_eq!(gatherer.take(b"def a():\n  if True:\n  end\n"), Ok(vec![]));
    assert_eq!(gatherer.take(b"end\nstopj(2)\n\n# nothing\n").expect("scripts").len(), 2);
}

#[test]
fn an_arm_at_its_limits_stops_itself() {
    let check = |script: &str, why: &str| {
        let mut controller = RUNNING.clone();
        assert!(controller.run_script(script));
        run(&mut controller, 12.0);
        let told = messages(&mut controller);
        assert!(told.iter().any(|line| line.contains(why)), "{script}: {told:?}");
        assert_eq!((controller.safety(), controller.state()), (SafetyMode::ProtectiveStop, ProgramState::Stopped));
        assert!(controller.arm_at(1.0).actual_speeds.iter().all(|speed| speed.abs() < 0.02));
    };
    let to = |change: &str| format!("q = get_actual_joint_positions()\n{change}\n");
    check(&to("q[5] = 7\nmovej(q, a=10, v=2)"), "a joint is at its limit");
    check(&to("q[0] = q[0] + 2\nmovej(q, a=40, v=6)"), "a joint would be faster than its limit");
    check(&to("q[1] = 0.3\nmovej(q)"), "protective stop");
    check(
        "here = get_target_tcp_pose()\nhere[0] = here[0] * 3\nmovel(here)\n",
        "a joint would be faster than its limit",
    );
    check("servoj([9, 9, 9, 9, 9, 9])\n", "a joint would be faster than its limit");
}

#[test]
fn the_slider_slows_a_path_and_a_pause_keeps_it() {
    let takes_s = |slider: f64, pause_s: f64| {
        let mut controller = RUNNING.clone();
        controller.speed_slider = slider;
        assert!(controller.run_script("q = get_actual_joint_positions()\nq[0] = q[0] + 0.6\nmovej(q)\n"));
        run(&mut controller, 0.4);
        if pause_s > 0.0 {
            assert!(controller.pause_program());
            run(&mut controller, 0.2);
            assert!(controller.arm_at(1.0).target_speeds.iter().all(|speed| *speed == 0.0));
            run(&mut controller, pause_s);
            assert!(controller.play());
        }
        let begun_s = controller.now_s();
        while controller.state() != ProgramState::Stopped {
            controller.cycle();
        }
        let moved = controller.arm_at(1.0).target[0] - RUNNING.arm_at(1.0).target[0];
        assert!((moved - 0.6).abs() < 1e-9, "{moved}");
        controller.now_s() - begun_s
    };
    let full_s = takes_s(1.0, 0.0);
    assert!(takes_s(0.2, 0.0) > 2.0 * full_s);
    assert!(takes_s(1.0, 3.0) < full_s + 1.0);
}

#[test]
fn faults_are_read_from_lines() {
    assert_eq!(Fault::read("help"), Ok(None));
    assert_eq!(Fault::read(" joint 6 "), Ok(Some(Fault::Joint(5))));
    assert_eq!(Fault::read("hand 0.1 -0.4 0.2"), Ok(Some(Fault::Hand(Some([0.1, -0.4, 0.2])))));
    assert_eq!(Fault::read("hand off"), Ok(Some(Fault::Hand(None))));
    assert_eq!(Fault::read("slow 250"), Ok(Some(Fault::Slow(0.25))));
    for wrong in ["joint 7", "joint", "hand 1 2", "slow -1", "slow NaN", "disconnect 1e9", "stop"] {
        assert!(Fault::read(wrong).expect_err("it is refused").contains("help prints what is"), "{wrong}");
    }
}

#[tokio::test]
async fn the_server_answers_on_its_ports_and_ends_connections_on_command() {
    let here = IpAddr::V4(Ipv4Addr::LOCALHOST);
    let server = ControllerServer::bind(here, [0; 5], OFF.clone()).await.expect("free ports");
    let [dashboard, _, script, _, rtde] = server.addresses()[..] else { panic!("five ports") };
    let (faults, lines) = mpsc::channel(4);
    let (told, mut messages) = mpsc::unbounded_channel();
    tokio::spawn(server.run(lines, move |line| {
        let _ = told.send(line.to_string());
    }));
    let long = Duration::from_secs(60);
    let mut dashboard = BufReader::new(TcpStream::connect(dashboard).await.expect("a dashboard"));
    let mut line = String::new();
    dashboard.read_line(&mut line).await.expect("a greeting");
    assert_eq!(line, "Connected: Universal Robots Dashboard Server\n");
    dashboard.write_all(b"robotmode\nget robot model\n").await.expect("two commands");
    line.clear();
    dashboard.read_line(&mut line).await.expect("an answer");
    dashboard.read_line(&mut line).await.expect("an answer");
    assert_eq!(line, "Robotmode: POWER_OFF\nUR5\n");

    let mut data = TcpStream::connect(rtde).await.expect("RTDE");
    let setup = [vec![0, 5, b'V', 0, 2], outputs(125.0, "robot_mode"), vec![0, 3, b'S']].concat();
    data.write_all(&setup).await.expect("a handshake");
    let mut answers = [0; 4 + 9 + 4 + 2 * 8];
    tokio::time::timeout(long, data.read_exact(&mut answers)).await.expect("in time").expect("packages");
    assert!(answers.ends_with(&[0, 8, b'U', 1, 0, 0, 0, 3]), "{answers:?}");

    // Without power no script runs, and clients of RTDE are told.
    TcpStream::connect(script).await.expect("scripts").write_all(b"stopj(2)\n").await.expect("a script");
    let told = tokio::time::timeout(long, messages.recv()).await.expect("in time").expect("a message");
    assert!(told.ends_with("the script does not run: the robot's mode is POWER_OFF, its safety mode NORMAL"), "{told}");
    faults.send(Fault::Disconnect(600.0)).await.expect("it is taken");
    let mut rest = Vec::new();
    tokio::time::timeout(long, data.read_to_end(&mut rest)).await.expect("in time").expect("the end");
    let text = b"the script does not run";
    assert!(rest.windows(text.len()).any(|part| part == text));
    line.clear();
    assert_eq!(dashboard.read_line(&mut line).await.expect("the end"), 0);
}
