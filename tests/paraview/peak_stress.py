# Run by pvpython: reads RUN.xmf and prints the largest von Mises stress of all its time steps, and how many there are.
import os
import sys
from paraview import servermanager
from paraview.simple import OpenDataFile

# Its Xdmf reader joins a bare file name to the data file's without a slash between them.
reader = OpenDataFile(os.path.abspath(sys.argv[1]))
reader.UpdatePipelineInformation()
times = list(reader.TimestepValues)
peak = 0.0
names = set()
for time in times:
    reader.UpdatePipeline(time)
    points = reader.PointData
    names.update(points.keys())
    low, high = points["von_mises_stress"].GetRange(0)
    peak = max(peak, high)
print("steps %d" % len(times))
print("fields %s" % " ".join(sorted(names)))
print("peak %.9g" % peak)
