"""Makes the example models, truth files and telemetry from Poinsot's own simulated data sets.

Source: the folders `ma2008`, `stsat3` and `xu2017` of the data set "Telemetry with truth, from MuJoCo
4.0.0 and Basilisk 2.12.1", each with one folder per run that holds truth.json, telemetry.parquet and
telemetry_noisy.csv. Numbers are copied digit by digit; nominal values are the truth moved by the amounts
written here, so that a good answer is not the nominal one.

    python3 data/convert.py DATASET_FOLDER [OUTPUT_FOLDER]
"""

import json
import shutil
import sys
from pathlib import Path

RUNS = {
    "stsat3": ["paper", "multiaxis", "bias"],
    "ma2008": ["traj1", "traj2", "traj2b", "traj1_wrist"],
    "xu2017": ["C1", "C2", "C3", "C4", "C5", "C6", "C7"],
}
# Files with noise as text: only those that the READMEs use. The others are Parquet, which is four times smaller;
# of those the columns that no model reads (accelerations, motor torques) are left out.
NOISY = {"stsat3/paper", "stsat3/multiaxis", "ma2008/traj1"}

# Nominal = factor * truth: mass and inertia of each body of xu2017.
XU_FACTORS = {
    "base": (0.97, 1.04),
    "B1": (1.05, 0.95),
    "B2": (0.96, 1.03),
    "B3": (1.04, 0.97),
    "B4": (0.95, 1.05),
    "B5": (1.06, 0.96),
    "B6": (1.03, 0.98),
}
XU_COM_SHIFT = (0.004, -0.003, 0.005)

TENSOR = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}


def number(x):
    return repr(float(x) + 0.0)


def vector(v):
    return "[" + ", ".join(number(x) for x in v) + "]"


def matrix(m):
    return "[" + ", ".join(vector(row) for row in m) + "]"


def tensor(m):
    entries = [f"{name} = {number(m[i][j])}" for name, (i, j) in TENSOR.items()]
    return "{ " + ", ".join(entries) + " }"


def name_of(body):
    return "spacecraft" if body["name"].startswith("spacecraft") else body["name"]


def body_text(name, mass, com, inertia, estimate=None):
    lines = ["[[body]]", f'name = "{name}"', f"mass_kg = {number(mass)}"]
    if mass > 0:
        lines += [f"com_m = {vector(com)}", f"inertia_kg_m2 = {tensor(inertia)}"]
    if estimate:
        lines.append(f"estimate = {estimate}")
    return "\n".join(lines) + "\n\n"


def joint_text(body, more=None):
    joint = body["joint"]
    lines = [
        "[[joint]]",
        f'name = "{joint["name"]}"',
        f'type = "{joint["type"]}"',
        f'parent = "{body["parent"]}"',
        f'child = "{body["name"]}"',
        f"origin_m = {vector(joint['origin_in_parent_m'])}",
    ]
    rotation = joint["R_parent_from_child_at_zero"]
    if rotation != [[1, 0, 0], [0, 1, 0], [0, 0, 1]]:
        lines.append(f"rotation_matrix = {matrix(rotation)}")
    lines.append(f"axis = {vector(joint['axis_in_child_frame'])}")
    if more:
        lines.append(more)
    return "\n".join(lines) + "\n\n"


def sensor_text(name, kind, key, value, bias=False):
    text = f'[[sensor]]\nname = "{name}"\ntype = "{kind}"\n{key} = {number(value)}\n'
    return text + ('bias = "estimate"\n\n' if bias else "\n")


def arm_sensors(noise, bias):
    return (
        sensor_text("gyro", "gyro", "noise_rad_s", noise["gyro_white_rad_s"], bias)
        + sensor_text("tracker", "attitude", "noise_rad", noise["star_tracker_rad_1sigma_per_axis"])
        + sensor_text("position", "position", "noise_m", noise["position_m"])
        + sensor_text("velocity", "velocity", "noise_m_s", noise["velocity_m_s"])
        + sensor_text("encoders", "joint_position", "quantisation_rad", noise["encoder_lsb_rad"])
        + sensor_text("joint_rates", "joint_rate", "noise_rad_s", noise["joint_rate_rad_s"])
    )


MOMENTUM = '[momentum]\nlinear_N_s = "estimate"\nangular_N_m_s = "estimate"\n'


def head(name, *comments):
    lines = [f"# {comment}" for comment in comments]
    return "\n".join(lines + ['schema = "poinsot.model/1"', f'name = "{name}"', 'exact = true']) + "\n\n"


def stsat3(truth):
    text = head(
        "stsat3",
        "STSAT-3 (Kim, Choi and Oh 2010): one body with three momentum wheels.",
        "The inertia is nominal, 5 to 8 % off the truth of the simulation and without products.",
        "No force acts, so the mass cannot be seen; it is given.",
    )
    nominal = [[15.0, 0, 0], [0, 16.0, 0], [0, 0, 21.0]]
    text += body_text("spacecraft", 150.0, [0, 0, 0], nominal, '["inertia"]')
    for wheel in truth["wheels"]:
        text += (
            f'[[wheel]]\nname = "{wheel["name"]}"\nbody = "spacecraft"\n'
            f"axis = {vector(wheel['axis_body'])}\n"
            f"spin_inertia_kg_m2 = {number(wheel['spin_inertia_kgm2'])}\n\n"
        )
    noise = truth["noise_of_noisy_file"]
    text += sensor_text("gyro", "gyro", "noise_rad_s", noise["gyro_white_rad_s"])
    text += sensor_text("tracker", "attitude", "noise_rad", noise["star_tracker_rad_1sigma_per_axis"])
    text += sensor_text("tachometers", "wheel_speed", "quantisation_rad_s", noise["wheel_tach_lsb_rad_s"])
    return {"model.toml": text + MOMENTUM}


def ma2008(truth):
    def model(bias, *comments):
        text = head(
            "ma2008",
            "Ma, Dang and Pham 2008: a 1000 kg cube with a six-joint arm; the arm is known, the cube is not.",
            *comments,
        )
        nominal = [[150.0, 0, 0], [0, 160.0, 0], [0, 0, 170.0]]
        text += body_text("base", 950.0, [0.01, -0.01, 0.02], nominal, "true")
        for body in truth["bodies"][1:]:
            text += body_text(
                body["name"],
                body["mass_kg"],
                body["com_m_body_frame"],
                body["inertia_about_com_body_axes_kgm2"],
            )
        for body in truth["bodies"][1:]:
            text += joint_text(body)
        return text + arm_sensors(truth["noise_of_noisy_file"], bias) + MOMENTUM

    return {
        "model.toml": model(False, "For the noise-free files: no bias."),
        "model_noisy.toml": model(True, "For the noisy files: their gyro has a constant bias."),
    }


def xu2017(truth):
    text = head(
        "xu2017",
        "Xu, Hu, Zhang and Liang 2017: a 400 kg base, a six-joint arm that holds a target, twelve thrusters.",
        "All seven bodies are unknown; the numbers are nominal, 2 to 6 % off the truth of the simulation.",
    )
    for body in truth["bodies"]:
        mass_factor, inertia_factor = XU_FACTORS[body["name"]]
        com = [round(c + d, 6) for c, d in zip(body["com_m_body_frame"], XU_COM_SHIFT)]
        inertia = [
            [round(inertia_factor * x, 6) for x in row]
            for row in body["inertia_about_com_body_axes_kgm2"]
        ]
        text += body_text(body["name"], round(mass_factor * body["mass_kg"], 6), com, inertia, "true")
    # Some campaigns have the arm at rest, the others no thrust.
    for body in truth["bodies"][1:]:
        text += joint_text(body, "locked_at_rad = 0.0")
    for thruster in truth["thrusters"]:
        text += (
            f'[[thruster]]\nname = "{thruster["name"]}"\nbody = "base"\n'
            f"position_m = {vector(thruster['position_m'])}\n"
            f"force_direction = {vector(thruster['force_direction_body'])}\n"
            "never_fires = true\n\n"
        )
    noise = truth["noise_of_noisy_file"]
    return {
        "model.toml": text + arm_sensors(noise, False) + MOMENTUM,
        "model_noisy.toml": text + arm_sensors(noise, True) + MOMENTUM,
    }


def poinsot_truth(truth):
    bodies = {}
    for body in truth["bodies"]:
        inertia = body["inertia_about_com_body_axes_kgm2"]
        bodies[name_of(body)] = {
            "mass_kg": {"value": body["mass_kg"]},
            "com_m": {"value": [float(x) for x in body["com_m_body_frame"]]},
            "inertia_kg_m2": {"value": {name: inertia[i][j] for name, (i, j) in TENSOR.items()}},
        }
    source = {key: value for key, value in truth.items() if key != "bodies"}
    return {"schema": "poinsot.truth/1", "bodies": bodies, "source": source}


def main():
    data = Path(sys.argv[1])
    out = Path(sys.argv[2]) if len(sys.argv) > 2 else Path(__file__).parent
    for case, make in (("stsat3", stsat3), ("ma2008", ma2008), ("xu2017", xu2017)):
        for k, run in enumerate(RUNS[case]):
            truth = json.loads((data / case / run / "truth.json").read_text())
            folder = out / case / run
            folder.mkdir(parents=True, exist_ok=True)
            if k == 0:
                for name, text in make(truth).items():
                    (out / case / name).write_text(text)
            converted = json.dumps(poinsot_truth(truth), indent=1)
            (folder / "truth.json").write_text(converted + "\n")
            shutil.copyfile(data / case / run / "telemetry.parquet", folder / "telemetry.parquet")
            if f"{case}/{run}" in NOISY:
                name = "telemetry_noisy.csv"
                shutil.copyfile(data / case / run / name, folder / name)
            else:
                noisy_parquet(data / case / run, folder)


def noisy_parquet(source, folder):
    """The noisy text file as Parquet (needs pyarrow)."""
    import pyarrow.csv
    import pyarrow.parquet

    table = pyarrow.csv.read_csv(source / "telemetry_noisy.csv")
    unread = [c for c in table.column_names if c.startswith("acc_") or c.endswith("_Nm")]
    pyarrow.parquet.write_table(
        table.drop_columns(unread),
        folder / "telemetry_noisy.parquet",
        compression="zstd",
        use_dictionary=False,
        use_byte_stream_split=True,
    )


if __name__ == "__main__":
    main()
