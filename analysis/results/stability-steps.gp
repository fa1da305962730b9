# Draws stability-steps.svg and stability-steps.pdf: gnuplot stability-steps.gp
set encoding utf8
set terminal svg size 1054,330 noenhanced font 'Helvetica,14' background '#ffffff'
set output 'stability-steps.svg'
set datafile separator comma
set datafile commentschars '#'
set datafile columnheaders
set datafile missing NaN
set grid lc rgb '#e0e0e0' lt 1
set border 3 lc rgb '#888888'
set tics nomirror scale 0.5 tc rgb '#333333'
set style line 1 lc rgb '#0072B2' lw 2 pt 7 ps 0.7
set style line 2 lc rgb '#D55E00' lw 2 pt 5 ps 0.7
set style line 3 lc rgb '#009E73' lw 2 pt 9 ps 0.8
set style line 4 lc rgb '#CC79A7' lw 2 pt 11 ps 0.8
set style line 5 lc rgb '#E69F00' lw 2 pt 13 ps 0.8
set style line 6 lc rgb '#56B4E9' lw 2 pt 6 ps 0.8
set style line 7 lc rgb '#555555' lw 2 pt 4 ps 0.8
set style line 8 lc rgb '#000000' lw 2 pt 8 ps 0.8
set termoption enhanced
set multiplot
unset grid
unset key
set border 15
shown(s) = s > 10000 ? 10000 : s < 0.001 ? 0.001 : s
label(s) = s > 1e4 ? '>10^4' : s < 1e-3 ? '<0.001' : s < 10 ? sprintf('%.2g', s) : sprintf('%.0f', s)
set palette defined (-3 '#0072B2', -0.001 '#d6e8f2', 0 '#fbe3d2', 4 '#D55E00')
set cbrange [-3:4]
unset colorbox
set xtics ('15' 0, '20' 1, '24' 2, '30' 3, '60' 4, '120' 5)
set ytics ('1' 0, '2' 1, '4' 2, '8' 3, '16' 4)
set xrange [-0.5:5.5]
set yrange [-0.5:4.5]
set xlabel 'frames a second'
set ylabel 'steps a frame'
set lmargin at screen 0.0607
set rmargin at screen 0.3561
set bmargin at screen 0.2000
set tmargin at screen 0.9091
unset arrow
set title 'ours (pinch)' offset 0,-0.6
plot 'stability-steps-map.csv' using (strcol('method') eq 'pinch' ? (column('x') == 15 ? 0 : column('x') == 20 ? 1 : column('x') == 24 ? 2 : column('x') == 30 ? 3 : column('x') == 60 ? 4 : column('x') == 120 ? 5 : NaN) : NaN):(column('y') == 1 ? 0 : column('y') == 2 ? 1 : column('y') == 4 ? 2 : column('y') == 8 ? 3 : column('y') == 16 ? 4 : NaN):(0.5):(0.5):(log10(shown(column('severity')))) with boxxyerror fs solid lc palette notitle, \
  '' using (strcol('method') eq 'pinch' ? (column('x') == 15 ? 0 : column('x') == 20 ? 1 : column('x') == 24 ? 2 : column('x') == 30 ? 3 : column('x') == 60 ? 4 : column('x') == 120 ? 5 : NaN) : NaN):(column('y') == 1 ? 0 : column('y') == 2 ? 1 : column('y') == 4 ? 2 : column('y') == 8 ? 3 : column('y') == 16 ? 4 : NaN):(label(column('severity'))) with labels font ',10' notitle
set lmargin at screen 0.3770
set rmargin at screen 0.6724
set bmargin at screen 0.2000
set tmargin at screen 0.9091
unset arrow
set title 'thesis' offset 0,-0.6
unset ylabel
set ytics ('' 0, '' 1, '' 2, '' 3, '' 4)
plot 'stability-steps-map.csv' using (strcol('method') eq 'thesis' ? (column('x') == 15 ? 0 : column('x') == 20 ? 1 : column('x') == 24 ? 2 : column('x') == 30 ? 3 : column('x') == 60 ? 4 : column('x') == 120 ? 5 : NaN) : NaN):(column('y') == 1 ? 0 : column('y') == 2 ? 1 : column('y') == 4 ? 2 : column('y') == 8 ? 3 : column('y') == 16 ? 4 : NaN):(0.5):(0.5):(log10(shown(column('severity')))) with boxxyerror fs solid lc palette notitle, \
  '' using (strcol('method') eq 'thesis' ? (column('x') == 15 ? 0 : column('x') == 20 ? 1 : column('x') == 24 ? 2 : column('x') == 30 ? 3 : column('x') == 60 ? 4 : column('x') == 120 ? 5 : NaN) : NaN):(column('y') == 1 ? 0 : column('y') == 2 ? 1 : column('y') == 4 ? 2 : column('y') == 8 ? 3 : column('y') == 16 ? 4 : NaN):(label(column('severity'))) with labels font ',10' notitle
set lmargin at screen 0.6932
set rmargin at screen 0.9886
set bmargin at screen 0.2000
set tmargin at screen 0.9091
unset arrow
set title 'plain cable joints' offset 0,-0.6
plot 'stability-steps-map.csv' using (strcol('method') eq 'cable' ? (column('x') == 15 ? 0 : column('x') == 20 ? 1 : column('x') == 24 ? 2 : column('x') == 30 ? 3 : column('x') == 60 ? 4 : column('x') == 120 ? 5 : NaN) : NaN):(column('y') == 1 ? 0 : column('y') == 2 ? 1 : column('y') == 4 ? 2 : column('y') == 8 ? 3 : column('y') == 16 ? 4 : NaN):(0.5):(0.5):(log10(shown(column('severity')))) with boxxyerror fs solid lc palette notitle, \
  '' using (strcol('method') eq 'cable' ? (column('x') == 15 ? 0 : column('x') == 20 ? 1 : column('x') == 24 ? 2 : column('x') == 30 ? 3 : column('x') == 60 ? 4 : column('x') == 120 ? 5 : NaN) : NaN):(column('y') == 1 ? 0 : column('y') == 2 ? 1 : column('y') == 4 ? 2 : column('y') == 8 ? 3 : column('y') == 16 ? 4 : NaN):(label(column('severity'))) with labels font ',10' notitle
unset multiplot

reset
set terminal pdfcairo size 10.979,3.438 noenhanced font 'Helvetica,11'
set output 'stability-steps.pdf'
set datafile separator comma
set datafile commentschars '#'
set datafile columnheaders
set datafile missing NaN
set grid lc rgb '#e0e0e0' lt 1
set border 3 lc rgb '#888888'
set tics nomirror scale 0.5 tc rgb '#333333'
set style line 1 lc rgb '#0072B2' lw 2 pt 7 ps 0.7
set style line 2 lc rgb '#D55E00' lw 2 pt 5 ps 0.7
set style line 3 lc rgb '#009E73' lw 2 pt 9 ps 0.8
set style line 4 lc rgb '#CC79A7' lw 2 pt 11 ps 0.8
set style line 5 lc rgb '#E69F00' lw 2 pt 13 ps 0.8
set style line 6 lc rgb '#56B4E9' lw 2 pt 6 ps 0.8
set style line 7 lc rgb '#555555' lw 2 pt 4 ps 0.8
set style line 8 lc rgb '#000000' lw 2 pt 8 ps 0.8
set termoption enhanced
set multiplot
unset grid
unset key
set border 15
shown(s) = s > 10000 ? 10000 : s < 0.001 ? 0.001 : s
label(s) = s > 1e4 ? '>10^4' : s < 1e-3 ? '<0.001' : s < 10 ? sprintf('%.2g', s) : sprintf('%.0f', s)
set palette defined (-3 '#0072B2', -0.001 '#d6e8f2', 0 '#fbe3d2', 4 '#D55E00')
set cbrange [-3:4]
unset colorbox
set xtics ('15' 0, '20' 1, '24' 2, '30' 3, '60' 4, '120' 5)
set ytics ('1' 0, '2' 1, '4' 2, '8' 3, '16' 4)
set xrange [-0.5:5.5]
set yrange [-0.5:4.5]
set xlabel 'frames a second'
set ylabel 'steps a frame'
set lmargin at screen 0.0607
set rmargin at screen 0.3561
set bmargin at screen 0.2000
set tmargin at screen 0.9091
unset arrow
set title 'ours (pinch)' offset 0,-0.6
plot 'stability-steps-map.csv' using (strcol('method') eq 'pinch' ? (column('x') == 15 ? 0 : column('x') == 20 ? 1 : column('x') == 24 ? 2 : column('x') == 30 ? 3 : column('x') == 60 ? 4 : column('x') == 120 ? 5 : NaN) : NaN):(column('y') == 1 ? 0 : column('y') == 2 ? 1 : column('y') == 4 ? 2 : column('y') == 8 ? 3 : column('y') == 16 ? 4 : NaN):(0.5):(0.5):(log10(shown(column('severity')))) with boxxyerror fs solid lc palette notitle, \
  '' using (strcol('method') eq 'pinch' ? (column('x') == 15 ? 0 : column('x') == 20 ? 1 : column('x') == 24 ? 2 : column('x') == 30 ? 3 : column('x') == 60 ? 4 : column('x') == 120 ? 5 : NaN) : NaN):(column('y') == 1 ? 0 : column('y') == 2 ? 1 : column('y') == 4 ? 2 : column('y') == 8 ? 3 : column('y') == 16 ? 4 : NaN):(label(column('severity'))) with labels font ',10' notitle
set lmargin at screen 0.3770
set rmargin at screen 0.6724
set bmargin at screen 0.2000
set tmargin at screen 0.9091
unset arrow
set title 'thesis' offset 0,-0.6
unset ylabel
set ytics ('' 0, '' 1, '' 2, '' 3, '' 4)
plot 'stability-steps-map.csv' using (strcol('method') eq 'thesis' ? (column('x') == 15 ? 0 : column('x') == 20 ? 1 : column('x') == 24 ? 2 : column('x') == 30 ? 3 : column('x') == 60 ? 4 : column('x') == 120 ? 5 : NaN) : NaN):(column('y') == 1 ? 0 : column('y') == 2 ? 1 : column('y') == 4 ? 2 : column('y') == 8 ? 3 : column('y') == 16 ? 4 : NaN):(0.5):(0.5):(log10(shown(column('severity')))) with boxxyerror fs solid lc palette notitle, \
  '' using (strcol('method') eq 'thesis' ? (column('x') == 15 ? 0 : column('x') == 20 ? 1 : column('x') == 24 ? 2 : column('x') == 30 ? 3 : column('x') == 60 ? 4 : column('x') == 120 ? 5 : NaN) : NaN):(column('y') == 1 ? 0 : column('y') == 2 ? 1 : column('y') == 4 ? 2 : column('y') == 8 ? 3 : column('y') == 16 ? 4 : NaN):(label(column('severity'))) with labels font ',10' notitle
set lmargin at screen 0.6932
set rmargin at screen 0.9886
set bmargin at screen 0.2000
set tmargin at screen 0.9091
unset arrow
set title 'plain cable joints' offset 0,-0.6
plot 'stability-steps-map.csv' using (strcol('method') eq 'cable' ? (column('x') == 15 ? 0 : column('x') == 20 ? 1 : column('x') == 24 ? 2 : column('x') == 30 ? 3 : column('x') == 60 ? 4 : column('x') == 120 ? 5 : NaN) : NaN):(column('y') == 1 ? 0 : column('y') == 2 ? 1 : column('y') == 4 ? 2 : column('y') == 8 ? 3 : column('y') == 16 ? 4 : NaN):(0.5):(0.5):(log10(shown(column('severity')))) with boxxyerror fs solid lc palette notitle, \
  '' using (strcol('method') eq 'cable' ? (column('x') == 15 ? 0 : column('x') == 20 ? 1 : column('x') == 24 ? 2 : column('x') == 30 ? 3 : column('x') == 60 ? 4 : column('x') == 120 ? 5 : NaN) : NaN):(column('y') == 1 ? 0 : column('y') == 2 ? 1 : column('y') == 4 ? 2 : column('y') == 8 ? 3 : column('y') == 16 ? 4 : NaN):(label(column('severity'))) with labels font ',10' notitle
unset multiplot

set output
