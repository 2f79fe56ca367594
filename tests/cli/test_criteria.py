from __future__ import annotations

import json


def test_criteria_of_a_ship(call):
    answer = call("criteria", "de-keizer", "--ship", "soesterberg", "--speed", "18 kn")
    assert answer.code == 0
    assert "evaluated against MSC.137(76) 5.3" in answer.out
    assert "compliant" not in answer.out


def test_criteria_as_json(call):
    answer = call("criteria", "norrbin", "--ship", "zeefakkel", "--json")
    assert answer.code == 0
    result = json.loads(answer.out)
    assert result["criteria"]["advance"]["limit"] == 4.5
    assert result["criteria"]["first_overshoot_10"]["limit"] == 10
    assert result["criteria"]["advance"]["starboard"]["value"] < 4.5
    assert result["spiral"]["half_width"] == {"value": 0, "unit": "deg", "interval_95": None}
    assert any("45 m long" in w["message"] for w in result["warnings"])


def test_criteria_of_an_own_ship_and_model(call, own_model, own_ship):
    answer = call("criteria", f"{own_model()}:Yaw", "--ship", own_ship(), "--json")
    assert answer.code == 0, answer
    assert json.loads(answer.out)["model"] == "yaw"


def test_refusals(refused, own_ship):
    refused(2, ["criteria", "de-keizer"], "--ship")
    refused(2, ["criteria", "de-keizr", "--ship", "soesterberg"], "de-keizer")
    refused(2, ["criteria", "de-keizer", "--ship", "soesterberg", "--speed", "0 kn"], "greater than zero")
    refused(2, ["criteria", "de-keizer", "--ship", "soesterberg", "--speed", "fast"], "'9 kn'")
    refused(3, ["criteria", "davidson-schiff", "--ship", own_ship()], "davidson-schiff")
