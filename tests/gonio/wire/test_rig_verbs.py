"""`gonio rig check`, `home`, `jog` and `stop`, on a served twin."""

import re

import pytest


def ok(result):
    assert result.returncode == 0, result.stderr
    return result.stdout


def refused(result, code, says):
    assert (result.returncode, result.stderr.count("\n")) == (code, 1), result.stderr
    assert says in result.stderr


@pytest.fixture(autouse=True)
def homed(gonio, served):
    return ok(gonio("rig", "home", "--rig", served.rig))


def test_home_says_where_everything_is(homed):
    assert [line.split()[0] for line in homed.splitlines()] == [
        "view_theta", "view_phi", "light_theta", "light_phi"
    ]  # fmt: skip


def test_jog(gonio, served):
    def jog(*words):
        return gonio("rig", "jog", *words, "--rig", served.rig)

    assert ok(jog("view_theta", "45", "--to")) == "view_theta 45.000 deg\n"
    assert ok(jog("view_theta", "+5")) == "view_theta 50.000 deg\n"
    assert ok(jog("view_theta", "-10")) == "view_theta 40.000 deg\n"
    refused(jog("view_theta", "60"), 2, "view_theta 100 deg is beyond the axis' travel")
    refused(jog("view_psi", "1"), 2, "there is no axis 'view_psi'; use view_theta, view_phi")
    refused(jog("view_theta", "nan"), 2, "is no angle")


def test_jog_is_refused_before_homing(gonio, served):
    served.tell("power", "off")
    served.tell("power", "on")
    refused(gonio("rig", "jog", "view_phi", "5", "--rig", served.rig), 3, "is not homed; home it")


def test_jog_keeps_clear(gonio, served, tmp_path):
    for axis, angle in (("view_phi", 0), ("light_phi", 0), ("light_theta", 60), ("view_theta", 20)):
        ok(gonio("rig", "jog", axis, angle, "--to", "--rig", served.rig))
    rig = tmp_path / "near.toml"
    text = served.rig.read_text()
    rig.write_text(text.replace("min_separation_deg = 0.0", "min_separation_deg = 15.0"))
    refused(gonio("rig", "jog", "view_theta", "55", "--to", "--rig", rig), 2, "deg (theta/phi) is")
    on_the_way = gonio("rig", "jog", "view_theta", "80", "--to", "--rig", rig)
    refused(on_the_way, 2, "on the way there the arms come too near")


def test_check_in_use(gonio, served):
    said = ok(gonio("rig", "check", "--exercise", "--rig", served.rig))
    assert "all is well" in said
    # the flux droops with the time that a lamp has burned, which here is real time
    assert len(re.findall(r"0\.111\d* at 70 mA", said)) == 11


def test_check_says_what_is_wrong_and_what_to_do(gonio, served):
    served.tell("door", "open")
    result = gonio("rig", "check", "--rig", served.rig)
    served.tell("door", "closed")
    assert result.returncode == 3
    said = " ".join(result.stdout.split())
    assert said.count("interlock open") == 4
    assert "close the door" in said
    assert result.stderr == "gonio: 4 things to see to\n"


def test_stop(gonio, served):
    said = ok(gonio("rig", "stop", "--rig", served.rig))
    assert said == "axes: stopped and disabled\nlamps: off\n"


def test_check_on_the_twin(gonio):
    assert "all is well" in ok(gonio("rig", "check", "--sim", "--exercise"))
    refused(gonio("rig", "check"), 2, "which rig?")
