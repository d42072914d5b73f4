"""Validates a unit, simulates it, and prints the physical units of its variables, then the bits of an output in each cycle.

Arguments: unit, and optionally the name of a real output and the number of cycles, with the inputs of a drive.
"""

import struct
import sys

import fmpy
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

PERIOD = 1e-3

unit = sys.argv[1]
problems = validate_fmu(unit)
if problems:
    sys.exit("\n".join(problems))
result = fmpy.simulate_fmu(unit, stop_time=0.1, step_size=PERIOD)
if len(result) < 2:
    sys.exit("the simulation has no rows")
if len(sys.argv) == 2:
    print("valid")
    sys.exit()

description = fmpy.read_model_description(unit)
print(" ".join(f"{v.name}: {v.unit}" for v in description.modelVariables if v.unit))
reference = {v.name: v.valueReference for v in description.modelVariables}
fmu = FMU3Slave(
    guid=description.guid,
    unzipDirectory=fmpy.extract(unit),
    modelIdentifier=description.coSimulation.modelIdentifier,
    instanceName="drive",
)
fmu.instantiate()
fmu.enterInitializationMode(startTime=0.0)
fmu.exitInitializationMode()
for cycle in range(int(sys.argv[3])):
    fmu.setBoolean([reference["on"]], [True])
    fmu.setFloat64([reference["wanted"]], [100.0])
    fmu.setFloat64([reference["measured"]], [(cycle % 50) * 0.1])
    fmu.doStep(currentCommunicationPoint=cycle * PERIOD, communicationStepSize=PERIOD)
    value = fmu.getFloat64([reference[sys.argv[2]]])[0]
    print(struct.pack(">d", value).hex())
fmu.terminate()
fmu.freeInstance()
