"""A machine of three joints in LinuxCNC's simulator: what the tests that start it share."""

HAL = """loadrt trivkins
loadrt motmod servo_period_nsec=1000000 num_joints=3
addf motion-command-handler servo-thread
addf motion-controller servo-thread
net x joint.0.motor-pos-cmd => joint.0.motor-pos-fb
net y joint.1.motor-pos-cmd => joint.1.motor-pos-fb
net z joint.2.motor-pos-cmd => joint.2.motor-pos-fb
net estop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in
net tool-prepare iocontrol.0.tool-prepare => iocontrol.0.tool-prepared
net tool-change iocontrol.0.tool-change => iocontrol.0.tool-changed
"""


def joints(limits, of_axis="", of_joint=lambda axis: ""):
    """The sections of the INI file from [KINS] on: `limits` of axes and joints, and further lines of each."""
    return """[KINS]
KINEMATICS = trivkins
JOINTS = 3
""" + "".join(f"""[AXIS_{axis}]
{of_axis}{limits}[JOINT_{joint}]
TYPE = LINEAR
{limits}HOME = 0
HOME_SEARCH_VEL = 0
HOME_LATCH_VEL = 0
HOME_SEQUENCE = 0
FERROR = 10
MIN_FERROR = 10
{of_joint(axis)}""" for joint, axis in enumerate("XYZ"))
